#include "app/insitu/arrays/particle_parts.h"

#include "app/insitu/arrays/gather_records.h"
#include "app/insitu/arrays/value_colors.h"
#include "qnv/codecs/encode.h"
#include "qnv/codecs/gaussians/splat_steps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace gs::app::insitu {
namespace {

// Standard deviation of the Gaussian of a particle, in radii, and opacity of the Gaussian.
constexpr double kDeviation = 0.5;
constexpr float kParticleOpacity = 0.95f;

std::array<double, 3> particle_at(const gs_insitu_particles& particles, std::size_t i) {
  std::array<double, 3> at{};
  const std::size_t bytes = bytes_of(particles.position_type);
  copy_doubles(particles.position_type, static_cast<const std::byte*>(particles.positions) + i * 3 * bytes,
               static_cast<std::int64_t>(bytes), 3, at.data());
  return at;
}

bool is_finite_point(const std::array<double, 3>& at) {
  return std::ranges::all_of(at, [](double part) { return std::isfinite(part); });
}

// Estimates the distance between neighbours, as if the particles filled their box evenly.
double spacing_of(const std::vector<ParticlePoint>& points) {
  std::array<float, 3> low{}, high{};
  low.fill(INFINITY);
  high.fill(-INFINITY);
  for (const ParticlePoint& point : points)
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], point.position[a]);
      high[a] = std::max(high[a], point.position[a]);
    }
  double longest = 0, volume = 1;
  for (std::size_t a = 0; a < 3; ++a) longest = std::max(longest, static_cast<double>(high[a]) - low[a]);
  if (!(longest > 0)) return 1;
  for (std::size_t a = 0; a < 3; ++a) volume *= std::max(static_cast<double>(high[a]) - low[a], longest / 100);
  return std::cbrt(volume / static_cast<double>(points.size()));
}

}  // namespace

std::variant<ParticlesView, std::string> particles_view(const gs_insitu_particles& particles) {
  ParticlesView view;
  view.particles = particles;
  if (particles.position_type != GS_INSITU_FLOAT32 && particles.position_type != GS_INSITU_FLOAT64)
    return "the positions of particles have an unknown type; expected GS_INSITU_FLOAT32 or GS_INSITU_FLOAT64";
  if (particles.count > 0 && !particles.positions)
    return "the positions of particles are missing; expected their address";
  if (!(particles.radius >= 0) || !std::isfinite(particles.radius))
    return "the radius of particles is negative or not finite; expected 0 or more";
  if (particles.field_count > kMaxFields) return "particles have more than 16 fields; expected at most 16";
  if (particles.field_count > 0 && !particles.fields)
    return "the fields of particles are missing; expected their address";
  for (std::size_t i = 0; i < particles.field_count; ++i) {
    auto field = field_view(particles.fields[i], {static_cast<std::int64_t>(particles.count), 1, 1});
    if (auto* problem = std::get_if<std::string>(&field)) return std::move(*problem);
    view.fields.push_back(std::move(std::get<FieldView>(field)));
  }
  return view;
}

void add_bounds(const ParticlesView& view, PartFacts& facts) {
  for (std::size_t i = 0; i < view.particles.count; ++i) {
    const auto at = particle_at(view.particles, i);
    if (!is_finite_point(at)) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      facts.low[a] = facts.count == 0 ? at[a] : std::min(facts.low[a], at[a]);
      facts.high[a] = facts.count == 0 ? at[a] : std::max(facts.high[a], at[a]);
    }
    ++facts.count;
  }
  facts.radius = std::max(facts.radius, view.particles.radius);
}

bool gather_particles(Ranks& ranks, std::span<const ParticlesView> parts, const StepPlan& plan,
                      ParticleValues& values) {
  values.field = plan.particle_field;
  values.origin = plan.origin;
  values.radius = plan.radius;
  values.stride = plan.particle_stride;
  const bool whole = ranks.attempt("particles", [&] {
    std::uint64_t number = 0;  // of the finite particles of this rank
    for (const ParticlesView& part : parts) {
      const FieldView* const field = find_field(part.fields, plan.particle_field);
      for (std::size_t i = 0; i < part.particles.count; ++i) {
        const auto at = particle_at(part.particles, i);
        if (!is_finite_point(at) || number++ % plan.particle_stride != 0) continue;
        ParticlePoint point;
        for (std::size_t a = 0; a < 3; ++a) point.position[a] = static_cast<float>(at[a] - plan.origin[a]);
        double sum = 0, one = std::numeric_limits<double>::quiet_NaN();
        for (std::uint32_t c = 0; field && c < field->components; ++c) {
          copy_doubles(field->type, field->at(static_cast<std::int64_t>(i), 0, 0, c), 0, 1, &one);
          sum += one * one;
        }
        point.value = static_cast<float>(field && field->components > 1 ? std::sqrt(sum) : one);
        values.points.push_back(point);
      }
    }
  });
  bool fits = true;
  if (!gather_records(ranks, values.points, plan.max_memory, whole, fits)) return false;
  values.too_large = !fits;
  return true;
}

std::optional<std::string> encode_particles(const ParticleValues& particles, qnv::EncodeOptions options,
                                            std::vector<std::byte>& bytes) {
  if (particles.too_large) return "not enough memory for the particles; set a smaller max_memory";
  if (particles.points.empty()) return "there are no particles";
  ValueColors colors;
  colors.title = particles.field.name.data();
  if (particles.field.unit[0] != 0) colors.title += std::string(" (") + particles.field.unit.data() + ")";
  for (const ParticlePoint& point : particles.points) colors.include(point.value);
  if (particles.field.name[0] != 0) options.metadata.push_back(colors.metadata());
  const double radius = particles.radius > 0 ? particles.radius : spacing_of(particles.points) / 2;
  const auto deviation = static_cast<float>(radius * kDeviation);
  qnv::Gaussians splats;
  splats.description.origin = {particles.origin[0], particles.origin[1], particles.origin[2]};
  const float area = static_cast<float>(std::numbers::pi) * deviation * deviation;
  for (const ParticlePoint& point : particles.points) {
    const glm::vec3 at(point.position[0], point.position[1], point.position[2]);
    const qnv::Rgb8 color = colors.color_of(point.value);
    splats.positions.push_back(at);
    splats.normals.emplace_back(0.0f, 0.0f, 1.0f);
    splats.weights.push_back(area);
    splats.colors.push_back(color);
    splats.scales.emplace_back(deviation);
    splats.rotations.emplace_back(0.0f, 0.0f, 0.0f, 1.0f);
    splats.opacities.push_back(kParticleOpacity);
    splats.bases.push_back(glm::vec3(color.r, color.g, color.b) / 255.0f);
    splats.description.box.add(at);
  }
  splats.description.total = static_cast<double>(area) * static_cast<double>(splats.size());
  splats.description.metadata = options.metadata;
  // Chooses steps so fine that the errors of positions are at most kParticleError. All particles are equally important.
  constexpr int kEighths = 8;
  for (options.splat_steps = 0; options.splat_steps > -qnv::GaussianCoding::kMostSteps; options.splat_steps -= kEighths)
    if (qnv::gaussians::splat_errors(options.splat_steps).place[0] * kDeviation <= kParticleError) break;
  auto encoded = qnv::encode(std::cref(splats), {qnv::Payload::gaussians, std::move(options)});
  if (auto* problem = std::get_if<qnv::EncodeError>(&encoded)) return std::move(problem->message);
  bytes = std::move(std::get<qnv::Encoding>(encoded).stream.bytes);
  return std::nullopt;
}

}  // namespace gs::app::insitu
