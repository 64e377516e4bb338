// Measures the effect of losses on displaced streams and on values of volumes.
//
//   loss_bench FILE... [--seeds N]
//
// Prints a Markdown table with a row per model: bytes, PSNR (dB) of the whole stream against pictures of the full model
// from six sides, 800x600, headlight, and its mean and worst decrease over N seeds (8) after the loss of 10 and 30 % of
// all packets beyond the first 16 kB, without retransmission.
//
// Prints another table per volume, for several protections: bytes of the whole stream, and for prefixes of several
// sizes the share of parity and the PSNR (dB) of the values over their range, without losses and with 10 and 30 % of
// all chunks lost (mean and worst of N seeds). No chunk is exempt.
#include "app/encode/surface_triangles.h"
#include "app/formats/volume/volume.h"
#include "app/loading/world_loader.h"
#include "bench/shared/picture_error.h"
#include "bench/shared/studio.h"
#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace {

using namespace gs;
using bench::Studio;

constexpr std::array<bench::View, 6> kViews{{{0, 0}, {60, 20}, {120, -20}, {180, 0}, {240, 30}, {300, -10}}};

bool measure(Studio& studio, const std::string& file, unsigned seeds) {
  app::LoadedWorld world = app::load_world(file);
  if (!world.scene) return false;
  render::MeshCache cache;
  const render::RenderList full = render::collect(*world.scene, world.images, cache);
  const auto references = studio.pictures(full, full.bounds, kViews);
  qnv::EncodeOptions options;
  options.two_sided = app::summarize_surface(full).two_sided;
  const qnv::TriangleSource source = [&](const qnv::TriangleSink& sink) { return app::for_each_triangle(full, sink); };
  // Encodes with default options, but displaced even where an octree suits better.
  options.only_if_suited = true;
  options.exact_bits = qnv::kExactWherePays;
  auto made = qnv::encode_displaced(source, options);
  if (std::exchange(options.only_if_suited, false) && std::holds_alternative<qnv::EncodeError>(made))
    made = qnv::encode_displaced(source, options);
  const auto* stream = std::get_if<qnv::EncodedStream>(&made);
  if (!stream) return false;
  const auto psnr = [&](std::span<const std::byte> bytes) {
    qnv::StreamDecoder decoder;
    (void)decoder.push(bytes);
    decoder.finish();
    const auto pictures = studio.pictures(bench::list_of(decoder.geometry()), full.bounds, kViews);
    return pictures.size() == references.size() ? bench::picture_error(pictures, references).psnr : 0;
  };
  const double whole = psnr(stream->bytes);
  std::printf("| %s | %zu | %.1f |", std::filesystem::path(file).filename().string().c_str(), stream->bytes.size(),
              whole);
  for (const double share : {0.1, 0.3}) {
    double sum = 0, worst = 0;
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      const double less = whole - psnr(qnv::drop_packets(stream->bytes, share, seed));
      sum += less;
      worst = std::max(worst, less);
    }
    std::printf(" %.1f | %.1f |", sum / seeds, worst);
  }
  std::printf("\n");
  std::fflush(stdout);
  return true;
}

std::vector<float> values_of(const qnv::VolumeSource& source) {
  std::vector<float> values(qnv::voxel_count(source.layout));
  std::vector<std::byte> scratch;
  const std::size_t slice = qnv::slice_voxels(source.layout);
  for (std::uint32_t z = 0; z < source.layout.dimensions[2]; ++z)
    (void)qnv::read_slice(source, z, scratch, std::span(values).subspan(z * slice, slice));
  for (float& value : values) value = value == value ? value : 0;
  return values;
}

/// Original values, to which decoded ones are compared.
class ValueMeter {
 public:
  explicit ValueMeter(const qnv::VolumeSource& source) : size_(source.layout.dimensions), values_(values_of(source)) {
    const auto [least, most] = std::ranges::minmax(values_);
    range_ = static_cast<double>(most) - static_cast<double>(least);
  }
  /// Returns the PSNR of decoded values over the range; of a coarse level, the nearest values.
  [[nodiscard]] double psnr(const qnv::StreamDecoder& decoder) const {
    const qnv::Geometry geometry = decoder.geometry();
    const auto* volume = geometry.as<qnv::Volume>();
    if (!volume || !volume->values) return 0;
    const std::vector<float> decoded = values_of(volume->values->source);
    const auto& part = volume->values->source.layout.dimensions;
    const int level = volume->values->level;
    double sum = 0;
    std::size_t i = 0;
    for (std::uint32_t z = 0; z < size_[2]; ++z)
      for (std::uint32_t y = 0; y < size_[1]; ++y)
        for (std::uint32_t x = 0; x < size_[0]; ++x, ++i) {
          const auto near = [&](std::uint32_t v, std::size_t a) { return std::min(v >> level, part[a] - 1); };
          const std::size_t at = (std::size_t{near(z, 2)} * part[1] + near(y, 1)) * part[0] + near(x, 0);
          sum += std::pow(static_cast<double>(decoded[at]) - static_cast<double>(values_[i]), 2);
        }
    return sum > 0 ? std::min(10 * std::log10(range_ * range_ * static_cast<double>(i) / sum), 99.9) : 99.9;
  }

 private:
  std::array<std::uint32_t, 3> size_;
  std::vector<float> values_;
  double range_ = 1;
};

struct SplitStream {
  qnv::StreamHeader header;
  std::vector<std::pair<qnv::ChunkType, std::vector<std::byte>>> chunks;
};

bool measure_volume(const qnv::VolumeSource& source, const std::string& name, unsigned seeds) {
  const ValueMeter meter(source);
  std::printf(
      "\n| %s, parity | bytes of all | prefix | of parity | no loss | 10 %%: mean | worst | 30 %%: mean | worst |\n"
      "|---|---:|---:|---:|---:|---:|---:|---:|---:|\n",
      name.c_str());
  for (const auto& [label, parity] : {std::pair<const char*, std::optional<double>>{"none", 0.0},
                                      {"default", std::nullopt},
                                      {"0.1", 0.1},
                                      {"0.3", 0.3}}) {
    qnv::EncodeOptions options;
    options.parity = parity;
    const auto made = qnv::encode_values(source, options);
    const auto* stream = std::get_if<qnv::EncodedStream>(&made);
    if (!stream) return false;
    for (const std::size_t prefix : {std::size_t{60'000}, std::size_t{250'000}, std::size_t{1'000'000}}) {
      SplitStream split;
      std::size_t of_parity = 0;
      qnv::StreamReader reader;
      (void)reader.push(std::span(stream->bytes).first(std::min(prefix, stream->bytes.size())),
                        [&](qnv::ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
                          if (type == qnv::ChunkType::parity) of_parity += qnv::kChunkHeaderBytes + payload.size();
                          split.chunks.emplace_back(type, std::vector(payload.begin(), payload.end()));
                        });
      const auto psnr = [&](double loss, unsigned seed) {
        std::mt19937 random(seed);
        qnv::StreamDecoder decoder;
        (void)decoder.push(qnv::encode_header(stream->header));
        for (const auto& [type, payload] : split.chunks)
          if (static_cast<double>(random()) >= loss * 4294967296.0) decoder.add(type, payload);
        return meter.psnr(decoder);
      };
      std::printf("| %s | %zu | %zu | %.1f %% | %.1f |", label, stream->bytes.size(), prefix,
                  100.0 * static_cast<double>(of_parity) / static_cast<double>(prefix), psnr(0, 0));
      for (const double loss : {0.1, 0.3}) {
        double sum = 0, worst = 100;
        for (unsigned seed = 1; seed <= seeds; ++seed) {
          const double one = psnr(loss, seed);
          sum += one;
          worst = std::min(worst, one);
        }
        std::printf(" %.1f | %.1f |", sum / seeds, worst);
      }
      std::printf("\n");
      std::fflush(stdout);
    }
  }
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<std::string> files;
  unsigned seeds = 8;
  for (int i = 1; i < count; ++i) {
    if (std::string(arguments[i]) == "--seeds" && i + 1 < count)
      seeds = static_cast<unsigned>(std::clamp(std::atoi(arguments[++i]), 1, 1000));
    else
      files.emplace_back(arguments[i]);
  }
  Studio studio;
  if (files.empty() || !studio.good()) {
    std::fprintf(stderr,
                 files.empty() ? "usage: loss_bench FILE... [--seeds N]\n" : "loss_bench: no way to draw here\n");
    return files.empty() ? 2 : 1;
  }
  bool headed = false;
  for (const std::string& file : files) {
    const auto opened = app::open_volume(file);
    const auto* volume = std::get_if<qnv::VolumeSource>(&opened);
    if (!volume && !std::exchange(headed, true))
      std::printf(
          "| model | bytes | no loss | 10 %%: mean | worst | 30 %%: mean | worst |\n"
          "|---|---:|---:|---:|---:|---:|---:|\n");
    const std::string name = std::filesystem::path(file).filename().string();
    if (!(volume ? measure_volume(*volume, name, seeds) : measure(studio, file, seeds))) {
      std::fprintf(stderr, "loss_bench: %s: no displaced stream and no volume\n", file.c_str());
      return 1;
    }
  }
  return 0;
}
