// surface_bench STREAM.qnv [OCTREE.qnv] [--frames N] [--detail D]... [--only TEXT]: measures pictures of a displaced
// surface.
//
// Decodes STREAM (payload displaced) and draws it at 1024x768 from N directions (12) around it, with cuts of edges of 1
// / D pixels (1, 2 and everything). Measures the cut, the processor's triangles alone, its splats alone and a whole
// frame. Compares them with the same surface as one mesh in OpenGL (llvmpipe on a machine without a GPU), and with the
// cut of OCTREE, an octree stream of the same model. Prints a Markdown table of milliseconds per frame: elapsed time of
// the fastest frame and on average, and processor time, which other programs disturb less. --only prints rows that
// contain TEXT.

#include "net/files/file.h"
#include "qnv/codecs/displaced/tessellation/surface_cut.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/reader/stream_decoder.h"
#include "render/draw/renderer.h"
#include "render/gl/context.h"
#include "render/scene/camera.h"
#include "render/scene/surface_mesh.h"
#include "render/splat/software/splat_raster.h"
#include "render/splat/splat_pieces.h"
#include "render/surface/patch_raster.h"

#include <glm/gtc/matrix_inverse.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <sys/resource.h>

namespace gs::bench {
namespace {

constexpr int kWidth = 1024, kHeight = 768;

struct Times {
  double wall = 0, processor = 0;
};

Times now() {
  struct rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(),
          seconds(usage.ru_utime) + seconds(usage.ru_stime)};
}

struct Row {
  std::string what;
  Times spent;          // sums over all frames
  double least = 1e30;  // elapsed time of the fastest frame
  double vertices = 0, triangles = 0;
};

void print(const Row& row, int frames) {
  std::printf("| %s | %.0f | %.0f | %.1f | %.1f | %.1f |\n", row.what.c_str(), row.vertices / frames / 1000,
              row.triangles / frames / 1000, 1000 * row.least, 1000 * row.spent.wall / frames,
              1000 * row.spent.processor / frames);
  std::fflush(stdout);
}

class Bench {
 public:
  Bench(qnv::Geometry patches, qnv::Geometry arrays, int frames, std::string only)
      : frames_(frames), only_(std::move(only)) {
    patches_ = std::make_shared<const qnv::Geometry>(std::move(patches));
    arrays_ = std::make_shared<const qnv::Geometry>(std::move(arrays));
    const Box box = this->patches().box();
    bounds_.add(box.lower);
    bounds_.add(box.upper);
    auto opened = render::open_headless_context("osmesa");
    if (auto* context = std::get_if<std::unique_ptr<render::GlContext>>(&opened)) context_ = std::move(*context);
    if (!context_) return;
    auto created = render::Renderer::create(*context_);
    if (auto* renderer = std::get_if<std::unique_ptr<render::Renderer>>(&created)) renderer_ = std::move(*renderer);
  }

  [[nodiscard]] render::Camera camera(int frame) const {
    return render::fit_depth(
        render::orbit_camera(bounds_, glm::radians(360.0f * static_cast<float>(frame) / static_cast<float>(frames_)),
                             glm::radians(15.0f), 0.785398f, kWidth, kHeight),
        bounds_);
  }
  [[nodiscard]] render::SplatView view(int frame) const {
    const render::Camera c = camera(frame);
    render::SplatView view;
    view.camera_from_node = glm::mat4(glm::affineInverse(c.world_from_camera));
    view.tangents = render::projection(c, kWidth, kHeight, true).tangents();
    view.width = kWidth;
    view.height = kHeight;
    view.near_plane = c.near_plane;
    view.supersample = 2;
    return view;
  }
  template <class Body>
  void each(const std::string& what, Body body) {
    if (what.find(only_) == std::string::npos) return;
    Row row;
    row.what = what;
    for (int frame = -1; frame < frames_; ++frame) {  // the first frame is not counted
      const int at = frame < 0 ? 0 : frame;
      const Times start = now();
      const std::pair<double, double> drawn = body(at);
      const Times end = now();
      if (frame < 0) continue;
      row.spent.wall += end.wall - start.wall;
      row.least = std::min(row.least, end.wall - start.wall);
      row.spent.processor += end.processor - start.processor;
      row.vertices += drawn.first;
      row.triangles += drawn.second;
    }
    print(row, frames_);
  }

  void run(float detail) {
    char name[32];
    if (detail > 100)
      std::snprintf(name, sizeof(name), "all there is");
    else
      std::snprintf(name, sizeof(name), "%.2g pixels", 1 / double{detail});
    const std::string of = std::string(", ") + name;
    const auto cut_of = [&](int frame) {
      auto looked = render::lod_view(view(frame));
      looked->error_pixels = 1 / detail;
      looked->leave_backs = !patches().description.two_sided;
      return qnv::cut_surface(patches(), *looked);
    };
    each("cut" + of, [&](int frame) { return std::pair(static_cast<double>(cut_of(frame).vertices), 0.0); });
    each("cut and triangles on the processor" + of, [&](int frame) {
      const auto layer = render::rasterize_patches(patches(), cut_of(frame), view(frame),
                                                   {patches().description.two_sided, {}, render::ColorBy::own});
      return std::pair(static_cast<double>(layer.discs), static_cast<double>(layer.drawn));
    });
    render::RenderList list = list_of(patches_, render::mesh_of_surface(*patches_));
    list.items.front().detail = detail;
    frame("whole frame, processor" + of, list, render::SplatPath::cpu);
    if (detail < 100) frame("whole frame, the cut with llvmpipe" + of, list, render::SplatPath::gl);
  }

  void beside(const std::shared_ptr<const qnv::Geometry>& octree) {
    qnv::Splats vertices;
    if (const auto* mesh = arrays_->as<qnv::IndexedMesh>()) static_cast<qnv::VectorArrays&>(vertices) = *mesh;
    const render::SplatPiece piece{&vertices, 0, vertices.size()};
    each("all vertices as discs, the raster alone", [&](int frame) {
      const auto layer = render::rasterize_surface(std::span(&piece, 1), view(frame));
      return std::pair(static_cast<double>(layer.discs), 0.0);
    });
    frame("whole frame, one mesh with llvmpipe", list_of(arrays_, render::mesh_of_surface(*arrays_)),
          render::SplatPath::gl);
    if (!octree) return;
    render::RenderList list;
    render::SplatItem item;
    item.geometry = octree;
    item.own_color = true;
    list.splats.push_back(item);
    list.bounds = bounds_;
    frame("whole frame, the octree's cut", list, render::SplatPath::cpu);
  }

  [[nodiscard]] bool ready() const { return renderer_ != nullptr; }

 private:
  [[nodiscard]] const qnv::SurfacePatches& patches() const { return *patches_->as<qnv::SurfacePatches>(); }
  [[nodiscard]] render::RenderList list_of(const std::shared_ptr<const qnv::Geometry>& surface,
                                           std::shared_ptr<const vrml::Mesh> mesh) const {
    render::RenderList list;
    render::DrawItem item;
    item.mesh = std::move(mesh);
    item.surface = surface;
    item.material.lit = false;
    render::dress_surface(item);
    list.items.push_back(std::move(item));
    list.bounds = bounds_;
    return list;
  }
  void frame(const std::string& what, const render::RenderList& list, render::SplatPath path) {
    render::DrawOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.splats = path;
    each(what, [&](int frame) {
      render::FrameStatistics statistics;
      const auto image = renderer_->draw_to_image(list, camera(frame), options, &statistics);
      (void)image;
      return std::pair(static_cast<double>(statistics.vectors), static_cast<double>(statistics.triangles));
    });
  }

  int frames_;
  std::string only_;
  std::shared_ptr<const qnv::Geometry> patches_, arrays_;
  Box bounds_;
  std::unique_ptr<render::GlContext> context_;
  std::unique_ptr<render::Renderer> renderer_;
};

int run(int argc, char** argv) {
  std::vector<std::string> paths;
  std::vector<float> details;
  std::string only;
  int frames = 12;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--frames" && i + 1 < argc)
      frames = std::max(1, std::atoi(argv[++i]));
    else if (word == "--only" && i + 1 < argc)
      only = argv[++i];
    else if (word == "--detail" && i + 1 < argc)
      details.push_back(std::strtof(argv[++i], nullptr));
    else
      paths.emplace_back(word);
  }
  if (paths.empty()) {
    std::fprintf(stderr, "usage: surface_bench STREAM.qnv [OCTREE.qnv] [--frames N] [--detail D]... [--only TEXT]\n");
    return 2;
  }
  if (details.empty()) details = {1, 2, 1000};
  const auto read = [](const std::string& path) {
    auto file = net::map_file(path);
    std::vector<std::byte> bytes;
    if (auto* mapped = std::get_if<net::MappedFile>(&file))
      bytes.assign(mapped->bytes().begin(), mapped->bytes().end());
    return bytes;
  };
  qnv::StreamDecoder decoder;
  const std::vector<std::byte> bytes = read(paths[0]);
  Times start = now();
  (void)decoder.push(bytes);
  decoder.finish();
  const Times numbers = now();
  qnv::Geometry drawn = decoder.geometry_to_draw();
  const auto* patches = drawn.as<qnv::SurfacePatches>();
  const Times made = now();
  if (!patches) {
    std::fprintf(stderr, "%s: no displaced stream\n", paths[0].c_str());
    return 1;
  }
  std::printf(
      "%s: %zu bytes, %zu vertices, %zu patches, level %d. Numbers %.0f ms, patches %.0f ms of processor time; %.0f "
      "MB.\n\n",
      paths[0].c_str(), bytes.size(), patches->parts[0]->vertex_count(), patches->parts[0]->size(),
      patches->parts[0]->level(), 1000 * (numbers.processor - start.processor),
      1000 * (made.processor - numbers.processor), static_cast<double>(patches->bytes()) / 1e6);
  std::shared_ptr<const qnv::Geometry> octree;
  if (paths.size() > 1) {
    auto opened = qnv::LodStream::open(read(paths[1]));
    if (auto* stream = std::get_if<std::unique_ptr<qnv::LodStream>>(&opened))
      octree = std::make_shared<const qnv::Geometry>(qnv::OctreeSplats(std::move(*stream)));
  }
  Bench bench(std::move(drawn), decoder.geometry(), frames, only);
  if (!bench.ready()) {
    std::fprintf(stderr, "no OpenGL\n");
    return 1;
  }
  std::printf(
      "| a frame of 1024x768 | thousand vertices | thousand triangles | least ms | ms | processor ms |\n| --- | "
      "--: | --: | --: | --: | --: |\n");
  for (const float detail : details) bench.run(detail);
  bench.beside(octree);
  return 0;
}

}  // namespace
}  // namespace gs::bench

int main(int argc, char** argv) { return gs::bench::run(argc, argv); }
