// Tests of meshes of a running world that take longer than a frame: the thread that makes them, the frame that shows
// them, and meshes that are dropped.
#include "render/scene/late_meshes.h"

#include "app/session/running/world_runtime.h"
#include "tests/app/worlds.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace gs::app::late_meshes_test {
namespace {

/// Gate that stops the worker before each mesh until the test opens it.
class Gate {
 public:
  void close() { set(true); }
  void open() { set(false); }
  void pass() {
    std::unique_lock lock(mutex_);
    ++waits_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return !closed_; });
    --waits_;
  }
  void wait_for_worker() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waits_ > 0; });
  }

 private:
  void set(bool closed) {
    const std::lock_guard lock(mutex_);
    closed_ = closed;
    changed_.notify_all();
  }
  std::mutex mutex_;
  std::condition_variable changed_;
  bool closed_ = false;
  int waits_ = 0;
};

/// Returns heights of an ElevationGrid of `side` x `side`, all equal to `height`.
vrml::MFFloat heights(std::size_t side, float height) {
  vrml::MFFloat all;
  for (std::size_t i = 0; i < side * side; ++i) all.push_back(height);
  return all;
}

std::string grid(std::size_t side, float height) {
  std::string text = "Shape { geometry ElevationGrid { xDimension " + std::to_string(side) + " zDimension " +
                     std::to_string(side) + " height [";
  for (std::size_t i = 0; i < side * side; ++i) text += ' ' + std::to_string(height);
  return text + "] } }";
}

constexpr std::size_t kLarge = 200;  // 79,202 triangles
constexpr std::size_t kSmall = 10;

struct World {
  explicit World(const std::string& body, bool with_worker = true) : opened(world_of(body)) {
    runtime = std::make_unique<WorldRuntime>(opened, meshes);
    runtime->start(1000);
    seen = runtime->look({0, 0, 10}, true);
    if (with_worker) runtime->set_mesh_worker(worker);
  }
  ~World() { gate.open(); }
  vrml::SceneGraph& scene() { return *opened.scene; }
  vrml::NodeId geometry(std::size_t shape = 0) { return scene().get<vrml::SFNode>(scene().roots()[shape], "geometry"); }
  void set_heights(std::size_t side, float height, std::size_t shape = 0) {
    CHECK(runtime->send(scene(), geometry(shape), "set_height", vrml::FieldValue(heights(side, height))));
  }
  /// Runs a frame, and returns its work in elements.
  std::uint64_t frame() {
    const std::uint64_t before = meshes.late ? meshes.late->work_in_frames() : 0;
    (void)runtime->take_meshes();
    runtime->step(time += 0.02);
    (void)runtime->show(*seen, {0, 0, 10});
    return meshes.late ? meshes.late->work_in_frames() - before : 0;
  }
  /// Returns the height of an item's mesh, or -1 without one.
  float height(std::size_t item = 0) {
    const auto& items = seen->scene.list().items;
    return item < items.size() ? items[item].mesh->bounds.upper.y : -1;
  }

  Gate gate;
  std::shared_ptr<render::MeshWorker> worker = std::make_shared<render::MeshWorker>(
      std::function<void()>{}, [this](const std::shared_ptr<const vrml::Mesh>&) { gate.pass(); });
  LoadedWorld opened;
  render::MeshCache meshes;
  std::unique_ptr<WorldRuntime> runtime;
  std::shared_ptr<RuntimeScene> seen;
  double time = 1000;
};

}  // namespace

TEST_CASE("makes a large mesh that changes each frame on a worker thread, and shows the results") {
  World world(grid(kLarge, 1));
  CHECK(world.height() == 1);
  float shown = 1;
  for (int i = 2; i < 20; ++i) {
    world.set_heights(kLarge, static_cast<float>(i));
    CHECK(world.frame() == 0);
    CHECK(world.height() >= shown);  // meshes appear in order, and none is missing
    CHECK(world.height() <= static_cast<float>(i));
    shown = world.height();
    if (i % 3 == 0) world.worker->wait();
  }
  CHECK(shown > 1);
  for (int i = 0; i < 2; ++i) {
    world.worker->wait();
    world.frame();
  }
  CHECK(world.height() == 19);  // the last mesh, although nothing changed since
  world.worker->wait();
  const std::uint64_t handed_over = world.meshes.late->handed_over();
  world.frame();
  CHECK(world.meshes.late->handed_over() == handed_over);
}

TEST_CASE("makes small meshes in the frame of the event, as time allows") {
  std::string body;
  constexpr std::size_t kShapes = 200, kSide = 12;
  for (std::size_t i = 0; i < kShapes; ++i) body += grid(kSide, 1) + "\n";
  World world(body);
  world.set_heights(kSide, 2);
  const std::uint64_t one = world.frame();
  CHECK(one == vrml::tessellation_cost(world.scene(), world.geometry()));
  CHECK(one > render::LateMeshes::kSmallWork);
  CHECK(world.height() == 2);
  CHECK(world.meshes.late->handed_over() == 0);
  for (std::size_t i = 0; i < kShapes; ++i) world.set_heights(kSide, 3, i);
  REQUIRE(one * kShapes > render::LateMeshes::kFrameWork);
  const std::uint64_t all = world.frame();
  CHECK(all <= render::LateMeshes::kFrameWork);
  CHECK(all > render::LateMeshes::kFrameWork - one);
  CHECK(world.meshes.late->handed_over() == kShapes - all / one);
  CHECK(world.height(0) == 3);
  CHECK(world.height(kShapes - 1) == 1);
  world.worker->wait();
  CHECK(world.frame() == 0);
  for (std::size_t i = 0; i < kShapes; ++i) CHECK(world.height(i) == 3);
}

TEST_CASE("makes the same mesh on a worker as in a frame, bit for bit") {
  const std::string body =
      "PROTO P [ field MFVec3f p [ ] ] { Coordinate { point IS p } } Shape { appearance Appearance { texture "
      "PixelTexture { image 1 1 1 9 } } geometry DEF F IndexedFaceSet { creaseAngle 1 coord P { p [ 0 0 0, 1 0 0, 1 1 "
      "0, 0 1 1 ] } color Color { color [ 1 0 0, 0 1 0, 0 0 1, 1 1 1 ] } } }";
  vrml::MFInt32 index;
  for (int i = 0; i < 60'000; ++i)
    for (const int corner : {i % 2, 1 + i % 2, 3, -1}) index.push_back(corner);
  const auto mesh_with = [&](bool with_worker) {
    World world(body, with_worker);
    CHECK(world.runtime->send(world.scene(), world.geometry(), "set_coordIndex", vrml::FieldValue(index)));
    world.frame();
    CHECK(world.seen->scene.list().items.empty() == with_worker);
    world.worker->wait();
    CHECK(world.frame() == 0);
    REQUIRE(world.seen->scene.list().items.size() == 1);
    return world.seen->scene.list().items[0].mesh;
  };
  const auto late = mesh_with(true), at_once = mesh_with(false);
  CHECK(late->indices.size() == 180'000);
  CHECK(late->positions == at_once->positions);
  CHECK(late->normals == at_once->normals);
  CHECK(late->colors == at_once->colors);
  CHECK(late->texture_coordinates == at_once->texture_coordinates);
  CHECK(late->indices == at_once->indices);
  CHECK(late->texture_coordinates.size() == late->positions.size());
}

TEST_CASE("skips all but the newest change while a mesh is being made") {
  World world(grid(kLarge, 1));
  world.gate.close();
  world.set_heights(kLarge, 2);
  world.frame();
  world.gate.wait_for_worker();
  for (const float height : {3.0f, 4.0f, 5.0f}) {
    world.set_heights(kLarge, height);
    world.frame();
    CHECK(world.height() == 1);
  }
  CHECK(world.meshes.late->handed_over() == 1);
  world.gate.open();
  world.worker->wait();
  world.frame();
  CHECK(world.height() == 2);
  world.worker->wait();
  world.frame();
  CHECK(world.height() == 5);
  CHECK(world.meshes.late->handed_over() == 2);
}

TEST_CASE("drops a late mesh of a worker if a newer one was made in a frame") {
  World world("Shape { geometry DEF F IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } } }");
  const auto set = [&](int triangles) {
    vrml::MFInt32 index;
    for (int i = 0; i < triangles; ++i)
      for (const int corner : {0, 1, 2 + i % 2, -1}) index.push_back(corner);
    CHECK(world.runtime->send(world.scene(), world.geometry(), "set_coordIndex", vrml::FieldValue(index)));
  };
  const auto triangles = [&] {
    const auto& items = world.seen->scene.list().items;
    return items.empty() ? 0 : items[0].mesh->indices.size() / 3;
  };
  world.gate.close();
  set(60'000);
  world.frame();
  world.gate.wait_for_worker();
  CHECK(triangles() == 0);
  set(2);
  world.frame();
  CHECK(triangles() == 2);
  world.gate.open();
  world.worker->wait();
  world.frame();
  CHECK(triangles() == 2);
}

TEST_CASE("survives removed nodes and closed worlds while their meshes are being made") {
  World world("Group { }");
  const auto children = [&](const vrml::MFNode& list) {
    CHECK(world.runtime->send(world.scene(), world.scene().roots()[0], "set_children", vrml::FieldValue(list)));
  };
  const auto make = [&](float height) {
    Diagnostics diagnostics;
    const vrml::NodeId made = vrml::read_into(world.scene(), "made.wrl", grid(kLarge, height), diagnostics).roots[0];
    CHECK(diagnostics.errors() == 0);
    world.runtime->execution().scenes().attach(world.scene());
    return made;
  };
  const auto only = [](vrml::NodeId node) {
    vrml::MFNode list;
    list.push_back(node);
    return list;
  };
  // Nodes that a program makes from a text are visible in the next frame.
  children(only(make(1)));
  CHECK(world.frame() == 0);
  CHECK(world.height() == -1);
  world.worker->wait();
  world.frame();
  CHECK(world.height() == 1);
  const std::uint64_t used = world.scene().budget()->used(Resource::meshes);
  CHECK(used > 0);

  world.gate.close();
  children(only(make(2)));
  world.frame();
  world.gate.wait_for_worker();
  children({});
  CHECK(world.runtime->execution().lifetime().remove_unheld() == 4);
  children(only(make(3)));  // in the slots of removed nodes
  world.frame();
  world.gate.open();
  world.worker->wait();
  world.frame();
  CHECK(world.height() == 3);
  CHECK(world.scene().budget()->used(Resource::meshes) == used);
  CHECK(world.runtime->execution().lifetime().replace_world(only(make(4))));
  world.frame();
  world.worker->wait();
  world.frame();
  CHECK(world.height() == 4);

  world.gate.close();
  world.set_heights(kLarge, 5, 0);
  world.frame();
  world.gate.wait_for_worker();
  world.meshes = {};
  world.seen.reset();
  world.gate.open();
}

TEST_CASE("makes long Text on a worker, and keeps it readable until the refined mesh is ready") {
  World world("Shape { geometry DEF T Text { string \"a\" } }");
  vrml::MFString lines;
  for (int i = 0; i < 40; ++i) lines.push_back(vrml::SFString("a line of some twenty characters " + std::to_string(i)));
  const std::size_t before = world.seen->scene.list().items.at(0).mesh->indices.size();
  CHECK(world.runtime->send(world.scene(), world.geometry(), "set_string", vrml::FieldValue(lines)));
  CHECK(world.frame() == 0);
  CHECK(world.seen->scene.list().items.at(0).mesh->indices.size() == before);
  for (int i = 0; i < 3; ++i) {
    world.worker->wait();
    CHECK(world.frame() == 0);
  }
  const std::size_t large = world.seen->scene.list().items.at(0).mesh->indices.size();
  CHECK(large > 20 * before);
  // Nearby glyphs are finer; until they are ready, the coarse ones are shown.
  (void)world.runtime->show(*world.seen, {0, 0, 0.5});
  CHECK(world.seen->scene.list().items.at(0).mesh->indices.size() == large);
  world.worker->wait();
  (void)world.runtime->take_meshes();
  (void)world.runtime->show(*world.seen, {0, 0, 0.5});
  CHECK(world.seen->scene.list().items.at(0).mesh->indices.size() > large);
}

}  // namespace gs::app::late_meshes_test
