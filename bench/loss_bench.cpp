// Measures the effect of losses on displaced streams.
//
//   loss_bench MODEL... [--seeds N]
//
// Prints a Markdown table with a row per model: bytes, PSNR (dB) of the whole stream against pictures of the full model
// from six sides, 800x600, headlight, and its mean and worst decrease over N seeds (8) after the loss of 10 and 30 % of
// all packets beyond the first 16 kB, without retransmission.
#include "app/encode/surface_triangles.h"
#include "app/loading/world_loader.h"
#include "bench/shared/picture_error.h"
#include "bench/shared/studio.h"
#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
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
                 files.empty() ? "usage: loss_bench MODEL... [--seeds N]\n" : "loss_bench: no way to draw here\n");
    return files.empty() ? 2 : 1;
  }
  std::printf(
      "| model | bytes | no loss | 10 %%: mean | worst | 30 %%: mean | worst |\n"
      "|---|---:|---:|---:|---:|---:|---:|\n");
  for (const std::string& file : files)
    if (!measure(studio, file, seeds)) {
      std::fprintf(stderr, "loss_bench: %s: no displaced stream\n", file.c_str());
      return 1;
    }
  return 0;
}
