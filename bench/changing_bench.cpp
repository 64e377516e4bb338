// Measures frames of a world with coordinates that change in every frame, before drawing, with meshes made in the frame
// and on a worker.
//
// changing_bench [TRIANGLES] [FRAMES]
#include "app/session/running/world_runtime.h"
#include "render/rays/item_bvh.h"
#include "render/scene/late_meshes.h"
#include "vrml/syntax/parser.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

using namespace gs;

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Times {
  std::vector<double> ms;
  void print(const char* what) {
    std::sort(ms.begin(), ms.end());
    std::printf("%s: median %.2f ms, worst %.2f ms of %zu frames", what, ms[ms.size() / 2], ms.back(), ms.size());
  }
};

void run(std::size_t side, int frames, bool beside, bool picks) {
  app::LoadedWorld opened;
  opened.scene = std::make_unique<vrml::SceneGraph>("changing.wrl");
  Diagnostics diagnostics;
  (void)vrml::parse("#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { creaseAngle 3 coord DEF C Coordinate { } } }",
                    *opened.scene, diagnostics);
  vrml::SceneGraph& scene = *opened.scene;
  const vrml::NodeId shape = scene.roots()[0], geometry = scene.get<vrml::SFNode>(shape, "geometry"),
                     coord = scene.get<vrml::SFNode>(geometry, "coord");
  vrml::MFInt32 index;
  for (std::size_t i = 0; i + 1 < side; ++i)
    for (std::size_t k = 0; k + 1 < side; ++k) {
      const auto at = static_cast<std::int32_t>(i * side + k), next = static_cast<std::int32_t>(at + side);
      for (const std::int32_t corner : {at, at + 1, next, -1, at + 1, next + 1, next, -1}) index.push_back(corner);
    }
  const auto points = [&](double time) {
    vrml::MFVec3f all;
    all.resize(side * side);
    vrml::SFVec3f* to = all.mutable_data();
    for (std::size_t i = 0; i < side; ++i)
      for (std::size_t k = 0; k < side; ++k)
        to[i * side + k] = {static_cast<float>(i) / static_cast<float>(side) - 0.5f,
                            static_cast<float>(0.05 * std::sin(time + 0.1 * static_cast<double>(i))),
                            static_cast<float>(k) / static_cast<float>(side) - 0.5f};
    return all;
  };
  scene.set(geometry, "coordIndex", index);
  scene.set(coord, "point", points(0));
  render::ItemBvh bvh;
  render::MeshCache meshes;
  app::WorldRuntime runtime(opened, meshes);
  runtime.start(1000);
  const auto seen = runtime.look({0, 0, 10}, true);
  const auto worker = std::make_shared<render::MeshWorker>(
      std::function<void()>{}, [trees = bvh.trees()](const auto& mesh) { trees->prepare(mesh); });
  if (beside) runtime.set_mesh_worker(worker);
  if (picks) bvh.prepare(seen->scene.list());
  // The events of a frame are prepared before its time is taken.
  std::vector<vrml::MFVec3f> waves;
  for (int i = 0; i < 8; ++i) waves.push_back(points(0.3 * i));
  Times times;
  std::size_t shown = 0;
  const vrml::Mesh* last = nullptr;
  for (int i = 1; i <= frames; ++i) {
    const auto start = Clock::now();
    (void)runtime.take_meshes();
    (void)runtime.send(scene, coord, "set_point", vrml::FieldValue(waves[static_cast<std::size_t>(i) % waves.size()]));
    runtime.step(1000 + i / 60.0);
    (void)runtime.show(*seen, {0, 0, 10});
    const render::RenderList& list = seen->scene.list();
    if (picks && !list.items.empty()) (void)bvh.nearest(list, {{0.1, 5, 0.1}, {0, -1, 0}});
    times.ms.push_back(ms_since(start));
    if (!list.items.empty() && list.items[0].mesh.get() != last) ++shown, last = list.items[0].mesh.get();
    std::this_thread::sleep_until(start + std::chrono::microseconds(16'667));
  }
  times.print(beside ? "beside the frames" : "in the frames");
  std::printf(", %zu meshes shown%s\n", shown, picks ? ", a line of sight a frame" : "");
}

}  // namespace

int main(int argc, char** argv) {
  const double triangles = argc > 1 ? std::atof(argv[1]) : 1e6;
  const int frames = argc > 2 ? std::atoi(argv[2]) : 120;
  const auto side = static_cast<std::size_t>(std::sqrt(std::clamp(triangles, 2.0, 1e7) / 2)) + 1;
  for (const bool picks : {false, true})
    for (const bool beside : {false, true}) run(side, beside ? frames : std::max(frames / 10, 3), beside, picks);
}
