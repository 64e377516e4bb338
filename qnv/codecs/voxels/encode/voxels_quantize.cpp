#include "qnv/codecs/voxels/encode/voxels_quantize.h"

#include "qnv/codecs/octree/encode/cluster_tree.h"
#include "qnv/codecs/octree/encode/residual_coding.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace gs::qnv {
namespace {

// Worth of one bit, in squared quantisation steps of the octahedron. A direction is encoded only if the picture gains
// more than the bits are worth.
constexpr double kBitWorth = 0.25;
// Dead zones: a value or magnitude keeps its prediction if the error is smaller. In quantisation steps.
constexpr double kValueZone = 0.62, kMagnitudeZone = 0.75;
// Gain of halving the voxel edge in a region, relative to a direction error of one radian.
constexpr double kFinerWorth = 0.3;
// Difference of values that counts as much as a direction error of one radian.
constexpr double kValueSeen = 48;

glm::vec3 unit_direction(int u, int v) {
  const std::array<int, 3> d = octahedral_normal(u, v);
  return glm::normalize(glm::vec3(static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])));
}

OctahedralPoint point_of(const glm::vec3& direction) {
  constexpr double kFineUnits = 1 << 20;
  const double norm = std::abs(static_cast<double>(direction.x)) + std::abs(static_cast<double>(direction.y)) +
                      std::abs(static_cast<double>(direction.z));
  if (!(norm > 0)) return {0, 0};
  std::array<int, 3> whole{};
  for (int i = 0; i < 3; ++i)
    whole[static_cast<unsigned>(i)] = static_cast<int>(std::lround(static_cast<double>(direction[i]) / norm * kFineUnits));
  return octahedral_of(whole);
}

double bits_of(int residual) { return residual == 0 ? 0.6 : 1.4 + 1.2 * std::abs(residual); }

/// Residuals of a direction that are worth their bits, and the direction that they give.
struct ChosenDirection {
  int du = 0, dv = 0, u = 0, v = 0;
};
ChosenDirection choose_direction(const OctahedralPoint& expected, const glm::vec3& truth, int step) {
  ChosenDirection best;
  const double worth = kBitWorth * step * step / (kOctahedral * kOctahedral);
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](int du, int dv) {
    int u = expected.u + du * step, v = expected.v + dv * step;
    wrap_octahedral(u, v);
    const double far = 2 - 2 * static_cast<double>(glm::dot(unit_direction(u, v), truth));
    const double cost = far + worth * (bits_of(du) + bits_of(dv));
    if (cost < least) {
      least = cost;
      best = {du, dv, u, v};
    }
  };
  consider(0, 0);
  if (least < worth * (bits_of(0) + bits_of(1))) return best;
  // Also tests the images of the direction beyond the edges of the octahedral square.
  const OctahedralPoint t = point_of(truth);
  constexpr int kAround = 2 * kOctahedral;
  const std::array<OctahedralPoint, 5> images{
      t, {kAround - t.u, -t.v}, {-kAround - t.u, -t.v}, {-t.u, kAround - t.v}, {-t.u, -kAround - t.v}};
  OctahedralPoint nearest = t;
  for (const OctahedralPoint& image : images)
    if (std::abs(image.u - expected.u) + std::abs(image.v - expected.v) <
        std::abs(nearest.u - expected.u) + std::abs(nearest.v - expected.v))
      nearest = image;
  const auto steps = [step](int away) { return static_cast<int>(std::lround(static_cast<double>(away) / step)); };
  const int du = steps(nearest.u - expected.u), dv = steps(nearest.v - expected.v);
  const auto towards = [](int d) { return d - (d > 0) + (d < 0); };
  consider(du, dv);
  consider(towards(du), dv);
  consider(du, towards(dv));
  consider(towards(du), towards(dv));
  return best;
}

int steps_beyond(double away, int step, double zone) {
  const double steps = away / step;
  return std::abs(steps) < zone ? 0 : static_cast<int>(std::lround(steps));
}

class VolumeQuantizer {
 public:
  VolumeQuantizer(const VolumeVoxels& from, const VoxelLattice& lattice, const VolumeParameters& parameters,
                  double edge, VolumeSymbols& out)
      : from_(from), lattice_(lattice), p_(parameters), turns_(parameters, lattice), edge_(edge), out_(out) {}

  void parent(std::size_t index, std::span<const TrueVoxel> below) {
    VolumeSymbols::Parent parent{
        static_cast<std::uint32_t>(index), 0, {}, static_cast<std::uint32_t>(out_.children.size())};
    const DirectionsAround around(from_, index);
    const std::array<int, 3>& own = around.own;
    for (const TrueVoxel& voxel : below) parent.mask = static_cast<std::uint8_t>(parent.mask | 1u << (voxel.key & 7));
    const ChildOdds odds(occupancy_odds(), own, from_.neighbours[index]);
    for (unsigned c = 0; c < 8; ++c) parent.odds[c] = static_cast<std::int16_t>(odds.of(c, parent.mask));
    std::array<std::uint8_t, 8> values{};
    for (const TrueVoxel& voxel : below) {
      VolumeSymbols::Child child{};
      const auto c = static_cast<unsigned>(voxel.key & 7);
      child.direction_context = static_cast<std::uint8_t>(residual_context(from_.activity[index]));
      child.value_context =
          static_cast<std::uint8_t>(residual_context(static_cast<std::uint8_t>(from_.activity[index] >> 2)));
      const int expected = predicted_value(from_.value[index], own, c, lattice_, p_.slope);
      child.value = steps_beyond(static_cast<double>(voxel.value) - expected, p_.value_step, kValueZone);
      values[c] = static_cast<std::uint8_t>(std::clamp(expected + child.value * p_.value_step, 0, 255));
      child.magnitude = steps_beyond(static_cast<double>(voxel.magnitude) - from_.magnitude[index], p_.magnitude_step,
                                     kMagnitudeZone);
      out_.children.push_back(child);
    }
    const glm::vec3 before = unit_direction(from_.u[index], from_.v[index]);
    for (std::size_t k = 0; k < below.size(); ++k) {
      const TrueVoxel& voxel = below[k];
      VolumeSymbols::Child& child = out_.children[parent.first_child + k];
      const auto c = static_cast<unsigned>(voxel.key & 7);
      const OctahedralPoint expected = predicted_direction(around, c, parent.mask, values, turns_);
      const float length = std::sqrt(glm::dot(voxel.gradient, voxel.gradient));
      const glm::vec3 truth = length > 0 ? voxel.gradient / length : unit_direction(expected.u, expected.v);
      const ChosenDirection chosen = choose_direction(expected, truth, p_.direction_step * kDirectionUnit);
      child.du = chosen.du;
      child.dv = chosen.dv;
      put(index, c, child, values[c], chosen);
      parent.gain += gain(voxel, truth, before, unit_direction(chosen.u, chosen.v), from_.value[index], values[c]);
    }
    out_.parents.push_back(parent);
  }

 private:
  void put(std::size_t index, unsigned c, const VolumeSymbols::Child& child, std::uint8_t value,
           const ChosenDirection& chosen) {
    VolumeVoxels& v = out_.voxels;
    v.x.push_back(static_cast<std::uint16_t>(from_.x[index] * 2 + (c & 1)));
    v.y.push_back(static_cast<std::uint16_t>(from_.y[index] * 2 + (c >> 1 & 1)));
    v.z.push_back(static_cast<std::uint16_t>(from_.z[index] * 2 + (c >> 2)));
    v.u.push_back(static_cast<std::int16_t>(chosen.u));
    v.v.push_back(static_cast<std::int16_t>(chosen.v));
    v.value.push_back(value);
    v.magnitude.push_back(static_cast<std::uint8_t>(
        std::clamp(from_.magnitude[index] + child.magnitude * p_.magnitude_step, 0, kMaxMagnitude)));
    const int turned = std::max(std::abs(child.du), std::abs(child.dv));
    v.activity.push_back(static_cast<std::uint8_t>(std::min(turned, 3) | std::min(std::abs(child.value), 3) << 2));
  }

  [[nodiscard]] double gain(const TrueVoxel& voxel, const glm::vec3& truth, const glm::vec3& before,
                            const glm::vec3& after, int value_before, int value_after) const {
    const auto turned = [&](const glm::vec3& d) {  // opposite directions count as equal
      return 1 - std::abs(static_cast<double>(glm::dot(truth, d)));
    };
    const auto off = [&](int value) { return std::abs(value - static_cast<double>(voxel.value)) / kValueSeen; };
    return voxel.seen * edge_ * edge_ *
           (kFinerWorth + std::max(0.0, turned(before) - turned(after)) +
            std::max(0.0, off(value_before) - off(value_after)));
  }

  const VolumeVoxels& from_;
  const VoxelLattice& lattice_;
  const VolumeParameters& p_;
  ValueTurns turns_;
  double edge_;
  VolumeSymbols& out_;
};

template <class T>
void copy_run(const std::vector<T>& from, std::size_t first, std::size_t last, std::vector<T>& to) {
  to.assign(from.begin() + static_cast<std::ptrdiff_t>(first), from.begin() + static_cast<std::ptrdiff_t>(last));
}

constexpr int kMaxOdds = 256;  // in 1/16; larger than every sum of table entries

}  // namespace

void fit_slopes(const VolumeVoxels& from, std::span<const std::span<const TrueVoxel>> below,
                const VoxelLattice& lattice, VolumeParameters& p) {
  // Fits two slopes by least squares. `slope`: how fast the values of children change along the parent's direction.
  // `turn`: how far a difference of values turns a direction.
  double along_value = 0, along_along = 0, rise_share = 0, rise_rise = 0;
  for (std::size_t i = 0; i < below.size(); ++i) {
    const std::array<int, 3> d = octahedral_normal(from.u[i], from.v[i]);
    for (const TrueVoxel& voxel : below[i]) {
      double along = 0;
      for (unsigned a = 0; a < 3; ++a)
        along += (voxel.key >> a & 1 ? d[a] : -d[a]) * static_cast<double>(lattice.lengths[a]);
      along /= 1 << 20;
      along_value += along * (static_cast<double>(voxel.value) - from.value[i]);
      along_along += along * along;
    }
    for (const TrueVoxel& one : below[i])
      for (const TrueVoxel& other : below[i])
        for (unsigned a = 0; a < 3; ++a) {
          if ((one.key ^ other.key) != (1u << a) || (one.key >> a & 1) == 0) continue;
          const double norm = std::abs(one.gradient.x) + std::abs(one.gradient.y) + std::abs(one.gradient.z);
          if (!(norm > 0)) continue;
          const double rise = (static_cast<double>(one.value) - other.value) * 256 / lattice.lengths[a];
          rise_share += rise * one.gradient[static_cast<int>(a)] / norm * kOctahedral;
          rise_rise += rise * rise;
        }
  }
  const auto whole = [](double v) { return static_cast<std::uint8_t>(std::clamp(v + 0.5, 0.0, 255.0)); };
  p.slope = along_along > 0 ? whole(along_value / along_along) : std::uint8_t{0};
  p.turn = rise_rise > 0 ? whole(rise_share / rise_rise * 1.5) : std::uint8_t{0};
  p.trust = p.turn > 0 ? p.trust : std::uint8_t{0};
}

VolumeSymbols quantize_volume(const VolumeVoxels& from, std::span<const std::span<const TrueVoxel>> below, double edge,
                              const VoxelLattice& lattice, const VolumeParameters& parameters) {
  VolumeSymbols out;
  out.parents.reserve(below.size());
  VolumeQuantizer quantizer(from, lattice, parameters, edge, out);
  for (std::size_t i = 0; i < below.size(); ++i) quantizer.parent(i, below[i]);
  return out;
}

VolumeSymbols chosen_symbols(const VolumeSymbols& all, std::size_t first, std::size_t count) {
  VolumeSymbols out;
  const auto [begin, end] = choose_parents(all, first, count, out);
  copy_run(all.children, begin, end, out.children);
  copy_run(all.voxels.x, begin, end, out.voxels.x);
  copy_run(all.voxels.y, begin, end, out.voxels.y);
  copy_run(all.voxels.z, begin, end, out.voxels.z);
  copy_run(all.voxels.u, begin, end, out.voxels.u);
  copy_run(all.voxels.v, begin, end, out.voxels.v);
  copy_run(all.voxels.value, begin, end, out.voxels.value);
  copy_run(all.voxels.magnitude, begin, end, out.voxels.magnitude);
  copy_run(all.voxels.activity, begin, end, out.voxels.activity);
  return out;
}

void choose_models(std::span<const VolumeSymbols> levels, VolumeParameters& p) {
  std::array<ResidualHistogram, kResidualContexts> direction{}, value{};
  ResidualHistogram magnitude{};
  std::vector<std::array<std::uint32_t, 2>> odds(2 * kMaxOdds);
  for (const VolumeSymbols& level : levels) {
    for (const VolumeSymbols::Parent& parent : level.parents)
      for (unsigned c = 0; c < 8; ++c)
        ++odds[static_cast<std::size_t>(parent.odds[c] + kMaxOdds)][parent.mask >> c & 1];
    for (const VolumeSymbols::Child& child : level.children) {
      count(direction[child.direction_context], child.du);
      count(direction[child.direction_context], child.dv);
      count(value[child.value_context], child.value);
      count(magnitude, child.magnitude);
    }
  }
  for (std::size_t i = 0; i < kResidualContexts; ++i) {
    p.direction[i] = cheapest(direction[i]);
    p.value[i] = cheapest(value[i]);
  }
  p.magnitude = cheapest(magnitude);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t model = 0; model < kSteepness.size(); ++model)
    for (int bias = 0; bias < 32; ++bias) {
      double cost = 0;
      for (int o = -kMaxOdds; o < kMaxOdds; ++o) {
        const auto& n = odds[static_cast<std::size_t>(o + kMaxOdds)];
        if (n[0] + n[1] == 0) continue;
        const double yes = probability_of(o + kOddsOfAll + 2 * (bias - VolumeParameters::kNoBias), logistic_table(),
                                          kSteepness[model]) /
                           static_cast<double>(kRansTotal);
        cost -= n[1] * std::log2(yes) + n[0] * std::log2(1 - yes);
      }
      if (cost < least) {
        least = cost;
        p.occupancy = static_cast<std::uint8_t>(model);
        p.bias = static_cast<std::uint8_t>(bias);
      }
    }
}

void put_level(const VolumeSymbols& level, const VolumeParameters& p, RansEncoder& rans) {
  const int all = kOddsOfAll + 2 * (static_cast<int>(p.bias) - VolumeParameters::kNoBias);
  for (const VolumeSymbols::Parent& parent : level.parents)
    for (unsigned c = 0; c < 8; ++c)
      put_bit(rans, c, probability_of(all + parent.odds[c], logistic_table(), kSteepness[p.occupancy]),
              (parent.mask >> c & 1) != 0);
  const auto& children = level.children;
  const std::size_t n = children.size();
  const auto direction = [&](std::size_t i) { return p.direction[children[i].direction_context]; };
  put_residuals(
      rans, n, [&](std::size_t i) { return children[i].value; },
      [&](std::size_t i) { return p.value[children[i].value_context]; });
  put_residuals(
      rans, n, [&](std::size_t i) { return children[i].magnitude; }, [&](std::size_t) { return p.magnitude; });
  put_residuals(
      rans, n, [&](std::size_t i) { return children[i].du; }, direction);
  put_residuals(
      rans, n, [&](std::size_t i) { return children[i].dv; }, direction);
}

void link_neighbours(const VolumeVoxels& from, std::size_t first, const VolumeSymbols& symbols,
                     VolumeVoxels& children) {
  std::vector<std::uint8_t> masks;
  std::vector<std::uint32_t> first_child;
  for (const VolumeSymbols::Parent& parent : symbols.parents) {
    masks.push_back(parent.mask);
    first_child.push_back(parent.first_child);
  }
  first_child.push_back(static_cast<std::uint32_t>(symbols.children.size()));
  link_neighbours(from, first, masks, first_child, children);
}

}  // namespace gs::qnv
