// Compares bytes with picture errors: QNV (displaced with default options and without the exact mesh, octree, records)
// and quadric-simplified meshes as Draco and as gzip'd VRML97.
//
//   rate_distortion MODEL... [--svg PLOT.svg] [--displaced-alone]
//
// Prints a Markdown table per model: for every budget PSNR (dB) and SSIM against pictures of the full model from six
// sides, 800x600, headlight. A budget of a QNV stream is a prefix of one file. A mesh needs its own file per budget,
// the best of several simplifications and quantisations. Needs draco_encoder and draco_decoder in the PATH.
#include "app/encode/surface_triangles.h"
#include "app/loading/world_loader.h"
#include "bench/shared/curve_plot.h"
#include "bench/shared/curve_table.h"
#include "bench/shared/mesh_files.h"
#include "bench/shared/picture_error.h"
#include "bench/shared/studio.h"
#include "bench/shared/surface_distance.h"
#include "qnv/codecs/payloads.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/reader/stream_decoder.h"

#include <meshoptimizer.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace gs;
using bench::list_of;
using bench::Mesh;
using bench::PictureError;
using bench::Studio;
using bench::SurfaceDistance;

constexpr std::array<std::size_t, 12> kBudgets{1000,   2000,    4000,    8000,    14'700,    32'000,
                                               64'000, 125'000, 250'000, 500'000, 1'000'000, 2'000'000};
constexpr std::array<bench::View, 6> kViews{{{0, 0}, {60, 20}, {120, -20}, {180, 0}, {240, 30}, {300, -10}}};
constexpr std::array<const char*, 6> kCodecs{"displaced", "without mesh", "packed", "records", "Draco", "gzip VRML"};

Mesh simplified(const Mesh& mesh, double part) {
  Mesh out;
  std::vector<unsigned> indices(mesh.indices.size());
  const auto target = static_cast<std::size_t>(static_cast<double>(mesh.indices.size()) * part) / 3 * 3;
  if (part < 1)
    indices.resize(meshopt_simplify(indices.data(), mesh.indices.data(), mesh.indices.size(), mesh.positions.data(),
                                    mesh.positions.size() / 3, 12, target, 1.0f, 0, nullptr));
  else
    indices = mesh.indices;
  std::vector<unsigned> places(mesh.positions.size() / 3, ~0u);
  for (const unsigned i : indices) {
    if (places[i] == ~0u) {
      places[i] = static_cast<unsigned>(out.positions.size() / 3);
      out.positions.insert(out.positions.end(),
                           {mesh.positions[3 * i], mesh.positions[3 * i + 1], mesh.positions[3 * i + 2]});
    }
    out.indices.push_back(places[i]);
  }
  return out;
}

struct Measured {
  std::size_t bytes = 0;
  PictureError error;
  SurfaceDistance distance;
};
using Curve = std::map<std::size_t, Measured>;  // by budget
using Curves = std::array<Curve, kCodecs.size()>;

Curve measure_stream(Studio& studio, const render::RenderList& full, const std::vector<render::Image>& references,
                     const Mesh& original, qnv::Payload payload, bool two_sided, int exact_bits = 0) {
  qnv::EncodeOptions options;
  options.two_sided = two_sided;
  options.max_bytes = kBudgets.back();
  options.exact_bits = exact_bits;
  const qnv::TriangleSource source = [&](const qnv::TriangleSink& sink) { return app::for_each_triangle(full, sink); };
  // Encodes with default options, but displaced even where an octree suits better.
  options.only_if_suited = payload == qnv::Payload::displaced && exact_bits <= 0;
  auto encoded = qnv::row_of(payload).encode(std::cref(source), options, nullptr);
  if (std::exchange(options.only_if_suited, false) && std::holds_alternative<qnv::EncodeError>(encoded))
    encoded = qnv::row_of(payload).encode(std::cref(source), options, nullptr);
  Curve curve;
  const auto* stream = std::get_if<qnv::EncodedStream>(&encoded);
  if (!stream) return curve;
  for (const std::size_t budget : kBudgets) {
    const std::size_t bytes = std::min(budget, stream->bytes.size());
    qnv::StreamDecoder decoder;
    decoder.push(std::span(stream->bytes).first(bytes));
    qnv::Geometry geometry = decoder.geometry();
    if (geometry.size() == 0) continue;
    const auto* surface = geometry.as<qnv::IndexedMesh>();
    const Mesh made = surface ? bench::mesh_of(*surface) : Mesh{};
    const auto pictures = studio.pictures(list_of(std::move(geometry)), full.bounds, kViews);
    if (pictures.size() != references.size()) continue;
    curve[budget] = {bytes, bench::picture_error(pictures, references), {}};
    if (!made.indices.empty()) curve[budget].distance = bench::surface_distance(original, made);
  }
  return curve;
}

// The best picture and the best surface can come from different files.
void keep_best(Curve& curve, std::size_t bytes, const PictureError& error, const SurfaceDistance& distance) {
  for (const std::size_t budget : kBudgets) {
    if (bytes > budget) continue;
    const bool first = !curve.contains(budget);
    Measured& best = curve[budget];
    if (first || error.psnr > best.error.psnr) {
      best.bytes = bytes;
      best.error = error;
    }
    if (first || distance.root_mean_square < best.distance.root_mean_square) best.distance = distance;
  }
}

void measure_meshes(Studio& studio, const render::RenderList& full, const std::vector<render::Image>& references,
                    const Mesh& mesh, Curve& draco, Curve& gzip) {
  const std::string base =
      (std::filesystem::temp_directory_path() / ("rate_distortion." + std::to_string(getpid()))).string();
  for (const double part : {0.0015, 0.003, 0.006, 0.01, 0.016, 0.025, 0.04, 0.07, 0.12, 0.2, 0.35, 0.6, 1.0}) {
    const Mesh small = simplified(mesh, part);
    if (small.indices.size() < 30) continue;
    if (!bench::write_obj(small, base + ".obj")) continue;
    for (const int bits : {7, 8, 9, 10, 11, 12, 14}) {
      if ((part < 0.01 && bits > 10) || (part > 0.1 && bits < 10)) continue;
      if (!bench::make_draco(base, bits)) continue;
      app::LoadedWorld world = app::load_world(base + ".out.obj");
      if (!world.scene) continue;
      render::MeshCache cache;
      const render::RenderList back = render::collect(*world.scene, world.images, cache);
      const auto pictures = studio.pictures(back, full.bounds, kViews);
      if (pictures.size() != references.size()) continue;
      const PictureError error = bench::picture_error(pictures, references);
      const SurfaceDistance distance = bench::surface_distance(mesh, bench::welded(back));
      keep_best(draco, std::filesystem::file_size(base + ".drc"), error, distance);
      // Six digits of text are finer than any of these quantisations.
      if (bits == 14 || (part < 0.01 && bits == 10))
        keep_best(gzip, bench::gzipped(bench::vrml_text(small)).size(), error, distance);
    }
  }
  for (const char* end : {".obj", ".drc", ".out.obj"}) std::filesystem::remove(base + end);
}

void plot(const std::string& path, const std::vector<std::pair<std::string, Curves>>& models) {
  constexpr std::array<const char*, 6> kColors{"#009944", "#004422", "#0066cc", "#66a3e0", "#cc3300", "#999999"};
  std::vector<bench::PlotCodec> codecs;
  for (std::size_t c = 0; c < kCodecs.size(); ++c) codecs.push_back({kCodecs[c], kColors[c]});
  std::vector<bench::PlotPanel> panels;
  for (const auto& [name, curves] : models) {
    bench::PlotPanel& panel = panels.emplace_back();
    panel.title = name;
    for (const Curve& curve : curves) {
      auto& plotted = panel.curves.emplace_back();
      for (const auto& [budget, measured] : curve) plotted[budget] = measured.error.psnr;
    }
  }
  bench::write_plot(path, codecs, panels, {15, 50});
}

/// Prints distances from the model to displaced streams, with and without the exact mesh, and to Draco's files.
void print_distances(const Curves& curves) {
  std::printf(
      "\n| budget, bytes | displaced: geometric PSNR | mean, 1e-4 | Hausdorff, 1e-4 | without mesh: geometric PSNR | "
      "mean | "
      "Hausdorff | Draco: geometric PSNR | mean | Hausdorff |\n|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  for (const std::size_t budget : kBudgets) {
    std::printf("| %zu |", budget);
    for (const Curve* curve : {&curves[0], &curves[1], &curves[4]}) {
      const auto found = curve->find(budget);
      if (found == curve->end())
        std::printf(" - | - | - |");
      else
        std::printf(" %.1f | %.2f | %.1f |", found->second.distance.psnr(), 1e4 * found->second.distance.mean,
                    1e4 * found->second.distance.most);
    }
    std::printf("\n");
  }
  std::printf("\n");
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<std::string> files;
  std::string svg;
  bool others = true;
  for (int i = 1; i < count; ++i) {
    if (std::string(arguments[i]) == "--svg" && i + 1 < count)
      svg = arguments[++i];
    else if (std::string(arguments[i]) == "--displaced-alone")
      others = false;
    else
      files.emplace_back(arguments[i]);
  }
  if (files.empty()) {
    std::fprintf(stderr, "usage: rate_distortion MODEL... [--svg PLOT.svg] [--displaced-alone]\n");
    return 2;
  }
  Studio studio;
  if (!studio.good()) {
    std::fprintf(stderr, "rate_distortion: no way to draw here\n");
    return 1;
  }
  std::vector<std::pair<std::string, Curves>> models;
  for (const std::string& file : files) {
    app::LoadedWorld world = app::load_world(file);
    if (!world.scene) {
      std::fprintf(stderr, "rate_distortion: %s cannot be opened\n", file.c_str());
      return 1;
    }
    render::MeshCache cache;
    const render::RenderList full = render::collect(*world.scene, world.images, cache);
    const app::SurfaceSummary summary = app::summarize_surface(full);
    const auto references = studio.pictures(full, full.bounds, kViews);
    const Mesh original = bench::welded(full);
    Curves curves;
    const auto stream = [&](qnv::Payload payload, int exact_bits = 0) {
      return measure_stream(studio, full, references, original, payload, summary.two_sided, exact_bits);
    };
    curves[0] = stream(qnv::Payload::displaced, qnv::kExactWherePays);
    curves[1] = stream(qnv::Payload::displaced);
    if (others) {
      curves[2] = stream(qnv::Payload::packed);
      curves[3] = stream(qnv::Payload::records);
      measure_meshes(studio, full, references, original, curves[4], curves[5]);
    }
    const std::string name = std::filesystem::path(file).filename().string();
    std::printf("### %s (%zu triangles)\n\n", name.c_str(), summary.triangles);
    bench::print_curve_table(kCodecs, kBudgets, curves);
    print_distances(curves);
    std::fflush(stdout);
    models.emplace_back(name, std::move(curves));
  }
  if (!svg.empty()) plot(svg, models);
  return 0;
}
