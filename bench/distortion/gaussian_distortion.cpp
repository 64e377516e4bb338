// Measures pictures of Gaussian splats over received bytes: `gaussian_distortion [--plot FILE.svg] [--pictures FOLDER]
// FILE...` prints for each file of splats the PSNR and SSIM over six views (800x600, black background) against the
// picture of the source. Codecs: prefixes of QNV streams of Gaussians and of discs, prefixes of .splat (largest splats
// first), and SPZ 4, SOG and compressed PLY, which must be received completely.
#include "app/formats/export/export.h"
#include "app/formats/splats/splats.h"
#include "app/loading/world_loader.h"
#include "bench/shared/curve_plot.h"
#include "bench/shared/curve_table.h"
#include "bench/shared/picture_error.h"
#include "bench/shared/sog_peer.h"
#include "qnv/codecs/payloads.h"
#include "qnv/reader/stream_decoder.h"
#include "render/gaussians/gaussian_raster.h"
#include "render/image/image.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace {

using namespace gs;

enum Codec : std::size_t { kStream, kDiscs, kSplat, kSpz, kSog, kCompressedPly, kCodecCount };
constexpr std::array<const char*, kCodecCount> kCodecs{"QNV Gaussians", "QNV discs", ".splat",
                                                       "SPZ 4",         "SOG",       "compressed PLY"};
constexpr std::array<std::size_t, 10> kBudgets{4000,    15'000,  30'000,    60'000,    125'000,
                                               250'000, 500'000, 1'000'000, 2'000'000, 4'000'000};

struct Measured {
  bench::PictureError error;
};
using Curve = std::map<std::size_t, Measured>;

/// Cameras around a model, which fill their pictures with it. Splats far away do not count.
class Studio {
 public:
  explicit Studio(const qnv::Gaussians& model) {
    glm::vec3 lower, upper;
    std::vector<float> values(model.size());
    for (int k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < model.size(); ++i) values[i] = model.positions[i][k];
      std::ranges::sort(values);
      lower[k] = values[values.size() / 100];
      upper[k] = values[values.size() - 1 - values.size() / 100];
    }
    middle_ = (lower + upper) * 0.5f;
    distance_ = 1.35f * glm::length(upper - lower);
  }

  [[nodiscard]] std::vector<render::Image> pictures(const qnv::Gaussians& gaussians) const {
    constexpr std::array<float, 6> kElevations{0.1f, 0.3f, -0.2f, 0.5f, 0.0f, 0.2f};
    render::SplatView view;
    view.width = 800;
    view.height = 600;
    view.tangents = {0.55f, 0.4125f};
    view.near_plane = 0.01f * distance_;
    std::vector<render::Image> all;
    for (std::size_t i = 0; i < kElevations.size(); ++i) {
      const float turn = 0.3f + 6.2831853f * static_cast<float>(i) / 6, up = kElevations[i];
      const glm::vec3 from(std::sin(turn) * std::cos(up), std::sin(up), std::cos(turn) * std::cos(up));
      render::GaussianItem item;
      item.gaussians = &gaussians;
      item.count = gaussians.size();
      item.camera_from_node = glm::lookAt(middle_ + distance_ * from, middle_, glm::vec3(0, 1, 0));
      const render::VolumeLayer layer = render::rasterize_gaussians({&item, 1}, view);
      render::Image& image = all.emplace_back();
      image.width = 800;
      image.height = 600;
      image.components = 3;
      image.pixels.assign(std::size_t{800} * 600 * 3, 0);
      for (std::size_t row = 0; row < 600 && !layer.pixels.empty(); ++row)
        for (std::size_t column = 0; column < 800; ++column)
          for (std::size_t k = 0; k < 3; ++k)
            image.pixels[3 * (800 * row + column) + k] = layer.pixels[4 * (800 * (599 - row) + column) + k];
    }
    return all;
  }

 private:
  glm::vec3 middle_{0};
  float distance_ = 1;
};

std::optional<qnv::Gaussians> read(const std::string& file) {
  const app::LoadedWorld world = app::load_world(file);
  for (const auto& [node, geometry] : world.geometries)
    if (const auto* gaussians = geometry->as<qnv::Gaussians>()) return *gaussians;
  return std::nullopt;
}

/// Returns what a stream of discs shows, as Gaussians like those of its exports.
qnv::Gaussians gaussians_of(const qnv::Geometry& geometry) {
  if (const auto* own = geometry.as<qnv::Gaussians>()) return *own;
  const auto exported = app::export_splats_ply(geometry, {});
  const auto* bytes = std::get_if<std::vector<std::byte>>(&exported);
  qnv::Gaussians none;
  if (!bytes) return none;
  const auto imported = app::import_splats_ply(*bytes);
  if (const auto* gaussians = std::get_if<qnv::Gaussians>(&imported)) return *gaussians;
  const auto* discs = std::get_if<qnv::Splats>(&imported);
  if (!discs) return none;
  for (std::size_t i = 0; i < discs->size(); ++i) {
    const float deviation = std::sqrt(discs->weights[i] / 6.2831853f);
    const glm::vec3 n = discs->normals[i];
    // The shortest turn from +Z to the normal.
    glm::vec4 turn(-n.y, n.x, 0, 1 + n.z);
    turn =
        n.z > -0.9999f ? turn / std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.w * turn.w) : glm::vec4(1, 0, 0, 0);
    const qnv::Rgb8 color = discs->colors.empty() ? discs->color : discs->colors[i];
    none.positions.push_back(discs->positions[i]);
    none.scales.emplace_back(deviation, deviation, deviation * 0.01f);
    none.rotations.push_back(turn);
    none.opacities.push_back(1);
    none.bases.push_back(glm::vec3(color.r, color.g, color.b) / 255.0f);
  }
  return none;
}

/// Returns the first splats of a .splat file, which orders them by volume and opacity.
qnv::Gaussians largest(const qnv::Gaussians& source, std::size_t count) {
  std::vector<std::size_t> order(source.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto size = [&](std::size_t i) {
    const glm::vec3& s = source.scales[i];
    return s.x * s.y * s.z * source.opacities[i];
  };
  std::ranges::stable_sort(order, std::ranges::greater{}, size);
  qnv::Gaussians some;
  for (std::size_t at = 0; at < std::min(count, order.size()); ++at) {
    const std::size_t i = order[at];
    some.positions.push_back(source.positions[i]);
    some.scales.push_back(source.scales[i]);
    some.rotations.push_back(source.rotations[i]);
    some.opacities.push_back(source.opacities[i]);
    some.bases.push_back(source.bases[i]);
  }
  return some;
}

/// Returns a table row with the smallest stream that is as good as a given PSNR; empty if there is none.
template <class ErrorOf>
std::string stream_as_good(const qnv::Gaussians& source, double psnr, const ErrorOf& error_of) {
  for (int steps = 0; steps >= -qnv::GaussianCoding::kMostSteps; steps -= 2) {
    qnv::EncodeOptions options;
    options.splat_steps = steps;
    const auto encoded = qnv::row_of(qnv::Payload::gaussians).encode(std::cref(source), options, nullptr);
    const auto* stream = std::get_if<qnv::EncodedStream>(&encoded);
    if (!stream) return {};
    qnv::StreamDecoder decoder;
    (void)decoder.push(stream->bytes);
    const double reached = error_of(gaussians_of(decoder.geometry())).error.psnr;
    if (reached < psnr) continue;
    char row[160];
    std::snprintf(row, sizeof row,
                  "| QNV Gaussians as good as SOG (steps %d, %.1f dB instead of %.1f) | %zu | %.1f |\n", steps, reached,
                  psnr, stream->bytes.size(),
                  8 * static_cast<double>(stream->bytes.size()) / static_cast<double>(source.size()));
    return row;
  }
  return {};
}

void save(const std::string& path, const render::Image& image) {
  std::ofstream out(path, std::ios::binary);
  out << "P6\n" << image.width << ' ' << image.height << "\n255\n";
  out.write(reinterpret_cast<const char*>(image.pixels.data()), static_cast<std::streamsize>(image.pixels.size()));
}

bool measure(const std::string& file, const std::string& folder, const std::string& streamed,
             std::vector<bench::PlotPanel>& panels) {
  const auto source = read(file);
  if (!source) return false;
  std::string name = std::filesystem::path(file).filename().string();
  if (name == "meta.json") name = std::filesystem::path(file).parent_path().filename().string();
  // Encodes before the first picture, so that times do not depend on the renderer.
  const auto start = std::chrono::steady_clock::now();
  const auto tree = qnv::row_of(qnv::Payload::gaussians).encode(std::cref(*source), {}, nullptr);
  const std::chrono::duration<double> encoding = std::chrono::steady_clock::now() - start;
  const auto discs = qnv::row_of(qnv::Payload::packed).encode(qnv::VectorView(*source), {}, nullptr);
  const Studio studio(*source);
  const std::vector<render::Image> references = studio.pictures(*source);
  const auto error_of = [&](const qnv::Gaussians& gaussians) {
    return Measured{bench::picture_error(studio.pictures(gaussians), references)};
  };
  std::array<Curve, kCodecCount> curves;
  std::array<std::size_t, kCodecCount> sizes{};
  double decoding = 0;
  std::string equal;
  for (const Codec codec : {kStream, kDiscs}) {
    const auto* stream = std::get_if<qnv::EncodedStream>(codec == kStream ? &tree : &discs);
    if (!stream) return false;
    sizes[codec] = stream->bytes.size();
    const std::span<const std::byte> bytes(stream->bytes);
    for (std::size_t budget : kBudgets) {
      const bool whole = budget >= bytes.size();
      qnv::StreamDecoder decoder;
      const auto begin = std::chrono::steady_clock::now();
      (void)decoder.push(bytes.first(std::min(budget, bytes.size())));
      const std::chrono::duration<double> decode = std::chrono::steady_clock::now() - begin;
      if (codec == kStream && whole) decoding = decode.count();
      const qnv::Gaussians shown = gaussians_of(decoder.geometry());
      curves[codec][budget] = error_of(shown);
      if (codec == kStream && !folder.empty())
        save(folder + "/" + name + "." + std::to_string(budget) + ".ppm", studio.pictures(shown)[1]);
      if (whole) break;
    }
  }
  for (const std::size_t budget : kBudgets) {
    curves[kSplat][budget] = error_of(largest(*source, budget / 32));
    if (budget >= 32 * source->size()) break;
  }
  sizes[kSplat] = 32 * source->size();
  const auto complete = [&](Codec codec, std::size_t bytes, const qnv::Gaussians& gaussians) {
    sizes[codec] = bytes;
    const Measured error = error_of(gaussians);
    for (const std::size_t budget : kBudgets)
      if (budget >= bytes) curves[codec][budget] = error;
  };
  const auto spz = app::export_spz(*source);
  if (const auto* bytes = std::get_if<std::vector<std::byte>>(&spz)) {
    const auto imported = app::import_splats_spz(*bytes);
    if (const auto* gaussians = std::get_if<qnv::Gaussians>(&imported)) complete(kSpz, bytes->size(), *gaussians);
  }
  if (source->degree == 0) {
    const bench::SogPeer sog = bench::sog_of(*source);
    complete(kSog, sog.bytes, sog.gaussians);
    equal = stream_as_good(*source, error_of(sog.gaussians).error.psnr, error_of);
  }
  if (name.ends_with(".compressed.ply")) complete(kCompressedPly, std::filesystem::file_size(file), *source);
  std::printf(
      "### %s (%zu splats, degree %d)\n\nEncoding %.1f s, decoding %.2f s.\n\n| codec | bytes | bits a splat |\n"
      "|---|---:|---:|\n",
      name.c_str(), source->size(), source->degree, encoding.count(), decoding);
  if (!equal.empty()) std::printf("%s", equal.c_str());
  for (std::size_t i = 0; i < kCodecCount; ++i)
    if (sizes[i] > 0)
      std::printf("| %s | %zu | %.1f |\n", kCodecs[i], sizes[i],
                  8 * static_cast<double>(sizes[i]) / static_cast<double>(source->size()));
  if (!streamed.empty())
    for (const bench::SogPeer& level : bench::sog_levels_of(streamed)) {
      const Measured error = error_of(level.gaussians);
      std::printf("| streamed SOG, level of %zu splats, %.1f dB / %.3f | %zu | |\n", level.gaussians.size(),
                  error.error.psnr, error.error.ssim, level.bytes);
    }
  std::printf("\n");
  bench::print_curve_table(kCodecs, kBudgets, curves);
  std::printf("\n");
  std::fflush(stdout);
  if (!folder.empty()) save(folder + "/" + name + ".source.ppm", references[1]);
  bench::PlotPanel& panel = panels.emplace_back(bench::PlotPanel{name, {}});
  for (const Curve& curve : curves)
    for (auto& plotted = panel.curves.emplace_back(); const auto& [budget, measured] : curve)
      if (budget <= 2'000'000) plotted[budget] = std::min(measured.error.psnr, 60.0);
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  std::string plot, folder, streamed;
  int first = 1;
  for (; first + 1 < count && arguments[first][0] == '-'; first += 2)
    (std::strcmp(arguments[first], "--plot") == 0       ? plot
     : std::strcmp(arguments[first], "--streamed") == 0 ? streamed
                                                        : folder) = arguments[first + 1];
  if (first >= count) {
    std::fprintf(stderr,
                 "usage: gaussian_distortion [--plot FILE.svg] [--pictures FOLDER] [--streamed FOLDER] FILE...\n");
    return 2;
  }
  std::vector<bench::PlotPanel> panels;
  for (int i = first; i < count; ++i)
    if (!measure(arguments[i], folder, streamed, panels)) {
      std::fprintf(stderr, "gaussian_distortion: %s has no Gaussian splats\n", arguments[i]);
      return 1;
    }
  const std::vector<bench::PlotCodec> look{{kCodecs[0], "#c00"}, {kCodecs[1], "#888"}, {kCodecs[2], "#08c"},
                                           {kCodecs[3], "#080"}, {kCodecs[4], "#a0a"}, {kCodecs[5], "#c80"}};
  if (!plot.empty()) bench::write_plot(plot, look, panels, {15, 60});
  return 0;
}
