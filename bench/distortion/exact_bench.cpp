// Compares the mesh at the end of a stream with Draco's file of as many bits.
//
//   exact_bench MODEL... [--bits N]
//
// Prints a Markdown table with a row per model: bytes before the tail, of the tail, in total, and of Draco's file
// (level 10); processor times in seconds; and PSNR (dB) of the header alone, of everything before the tail, of the
// whole stream, and of Draco's file, against pictures of the full model from six sides, 800x600, headlight. Needs
// draco_encoder and draco_decoder in the PATH.
#include "app/encode/surface_triangles.h"
#include "app/loading/world_loader.h"
#include "bench/shared/mesh_files.h"
#include "bench/shared/picture_error.h"
#include "bench/shared/studio.h"
#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/reader/stream_decoder.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace {

using namespace gs;
using bench::Studio;

constexpr std::array<bench::View, 6> kViews{{{0, 0}, {60, 20}, {120, -20}, {180, 0}, {240, 30}, {300, -10}}};

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// End of the header and start of the tail.
struct Places {
  std::size_t header = 0, tail = 0;
};

Places places_of(std::span<const std::byte> stream) {
  Places places{0, stream.size()};
  bool more = false;
  (void)qnv::decode_header(stream, places.header, more);
  qnv::StreamReader reader;
  (void)reader.push(stream, [&](qnv::ChunkType type, std::span<const std::byte>, std::uint64_t at) {
    if (type == qnv::ChunkType::exact) places.tail = std::min<std::size_t>(places.tail, at);
  });
  return places;
}

bool measure(Studio& studio, const std::string& file, int bits) {
  app::LoadedWorld world = app::load_world(file);
  if (!world.scene) return false;
  render::MeshCache cache;
  const render::RenderList full = render::collect(*world.scene, world.images, cache);
  const auto references = studio.pictures(full, full.bounds, kViews);
  const auto psnr = [&](const render::RenderList& list) {
    const auto pictures = studio.pictures(list, full.bounds, kViews);
    return pictures.size() == references.size() ? bench::picture_error(pictures, references).psnr : 0;
  };
  qnv::EncodeOptions options;
  options.exact_bits = bits;
  options.threads = 1;
  options.two_sided = app::summarize_surface(full).two_sided;
  const qnv::TriangleSource source = [&](const qnv::TriangleSink& sink) { return app::for_each_triangle(full, sink); };
  const double start = processor_seconds();
  const auto made = qnv::encode_displaced(source, options);
  const double encoded = processor_seconds();
  const auto* stream = std::get_if<qnv::EncodedStream>(&made);
  if (!stream) return false;
  const auto shown = [&](std::size_t bytes) {
    qnv::StreamDecoder decoder;
    (void)decoder.push(std::span(stream->bytes).first(bytes));
    return decoder.geometry();
  };
  const Places places = places_of(stream->bytes);
  const double before = processor_seconds();
  qnv::StreamDecoder decoder;
  (void)decoder.push(stream->bytes);
  decoder.finish();
  const double decoded = processor_seconds();
  const qnv::Geometry geometry = decoder.geometry();
  const auto* surface = geometry.as<qnv::IndexedMesh>();
  const double header_psnr = psnr(bench::list_of(shown(places.header)));
  const double refined_psnr = psnr(bench::list_of(shown(places.tail))), whole_psnr = psnr(bench::list_of(geometry));

  const std::string base =
      (std::filesystem::temp_directory_path() / ("exact_bench." + std::to_string(getpid()))).string();
  std::size_t draco = 0;
  double draco_psnr = 0;
  if (bench::write_obj(bench::welded(full), base + ".obj") && bench::make_draco(base, bits)) {
    draco = std::filesystem::file_size(base + ".drc");
    app::LoadedWorld back = app::load_world(base + ".out.obj");
    render::MeshCache own;
    if (back.scene) draco_psnr = psnr(render::collect(*back.scene, back.images, own));
  }
  for (const char* end : {".obj", ".drc", ".out.obj"}) std::filesystem::remove(base + end);
  const std::size_t triangles = surface ? surface->triangles.size() / 3 : 0, whole = stream->bytes.size();
  std::printf("| %s | %zu | %zu | %zu | %zu | %zu | %zu | %.3f | %.1f / %.1f / %.1f / %.1f | %.2f | %.3f | %.1f |\n",
              std::filesystem::path(file).filename().string().c_str(), decoder.vectors(), triangles, places.tail,
              decoder.mesh().bytes, whole, draco,
              draco > 0 ? static_cast<double>(whole) / static_cast<double>(draco) : 0, header_psnr, refined_psnr,
              whole_psnr, draco_psnr, encoded - start, decoded - before,
              static_cast<double>(triangles) / 1e6 / (decoded - before));
  std::fflush(stdout);
  return decoder.mesh().whole;
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<std::string> files;
  int bits = 11;
  for (int i = 1; i < count; ++i) {
    if (std::string(arguments[i]) == "--bits" && i + 1 < count)
      bits = std::atoi(arguments[++i]);
    else
      files.emplace_back(arguments[i]);
  }
  if (files.empty() || bits < 8 || bits > 20) {
    std::fprintf(stderr, "usage: exact_bench MODEL... [--bits 8 to 20]\n");
    return 2;
  }
  Studio studio;
  if (!studio.good()) {
    std::fprintf(stderr, "exact_bench: no way to draw here\n");
    return 1;
  }
  std::printf(
      "| model | vertices | triangles | before the tail | tail | whole | Draco | whole / Draco | PSNR of header / "
      "before the "
      "tail / whole / Draco | encode, s | decode, s | M triangles/s |\n"
      "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  for (const std::string& file : files)
    if (!measure(studio, file, bits)) {
      std::fprintf(stderr, "exact_bench: %s: no exact stream\n", file.c_str());
      return 1;
    }
  return 0;
}
