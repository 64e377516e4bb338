#include "render/collection/nodes/screen.h"

#include "render/collection/render_scene.h"
#include "vrml/scene/node_names.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <glm/glm.hpp>

#include <algorithm>
#include <memory>
#include <string>

// Tests of the Layout component (X3D 36): rectangles, and content in units of the picture.
namespace gs::render::layout_test {
namespace {

/// World of X3D with layers, in a picture that can change its size.
class LayoutWorld {
 public:
  explicit LayoutWorld(const std::string& body, glm::dvec2 pixels = {800, 600})
      : scene_(std::make_unique<vrml::SceneGraph>("text.x3dv")) {
    Diagnostics diagnostics;
    scene_->texts().at(0).set_language(vrml::Language::x3d, 40);
    (void)vrml::Parser(*scene_, diagnostics).parse_fragment(body);
    for (const Diagnostic& diagnostic : diagnostics.entries()) UNSCOPED_INFO(diagnostic.text());
    REQUIRE(diagnostics.errors() == 0);
    execution_ = std::make_unique<vrml::Execution>(*scene_);
    names_ = std::make_unique<vrml::NodeNames>(*scene_);
    render_ = std::make_unique<RenderScene>(*scene_, images_, geometries_, meshes_);
    execution_->start(1000);
    sight.pixels = pixels;
    (void)execution_->changes().take();
    render_->set_sight(sight);
    render_->gather(bound(), viewer);
  }

  bool update() {
    const auto changes = execution_->changes().take();
    forget_changed(meshes_, changes);
    render_->set_sight(sight);
    return render_->update(changes, bound(), viewer);
  }
  template <class T>
  void send(const std::string& target, T value) {
    const std::size_t point = target.rfind('.');
    const vrml::NodeId node = names_->find(target.substr(0, point));
    REQUIRE(node);
    const vrml::InterfaceDeclaration* event = scene_->node(node).type->find_event_in(target.substr(point + 1));
    REQUIRE(event);
    execution_->step(1000 + ++steps_ * 0.01);
    CHECK(execution_->send(*scene_, node, *event, vrml::FieldValue(std::move(value))));
  }
  [[nodiscard]] const RenderList& list() const { return render_->list(); }
  /// Returns the list of the first layer that is not active.
  [[nodiscard]] const RenderList& layer() const { return *render_->list().layers.at(0).list; }
  [[nodiscard]] std::size_t gathered() const { return render_->gathered(); }
  [[nodiscard]] vrml::NodeId node(const std::string& name) { return names_->find(name); }

  /// Returns the rectangle of a 1 x 1 square in the picture of a parallel layer: left, bottom, width, height in pixels.
  [[nodiscard]] glm::dvec4 pixels_of(const DrawItem& item) const {
    const RenderLayer& layer = render_->list().layers.at(0);
    const vrml::ClipBoundary& part = layer.list->boundary;
    const glm::dvec2 size(sight.pixels.x * (part[1] - part[0]), sight.pixels.y * (part[3] - part[2]));
    const double pixel = 2 / std::min(size.x, size.y);
    const glm::dvec2 center = glm::dvec2(item.world_from_node[3]) / pixel + size / 2.0;
    const glm::dvec2 extent(item.world_from_node[0].x / pixel, item.world_from_node[1].y / pixel);
    return {center - extent / 2.0, extent};
  }

  Sight sight;
  glm::dvec3 viewer{0, 0, 10};

 private:
  [[nodiscard]] BoundNodes bound() const {
    BoundNodes nodes;
    const std::optional<vrml::LayerSet> set = execution_->stacks().layers();
    if (!set) return nodes;
    nodes.layer_set = set->node;
    nodes.layer = set->active;
    for (const int layer : set->order) {
      if (layer == set->active) continue;
      const vrml::NodeId id = set->layers.at(static_cast<std::size_t>(layer) - 1);
      BoundLayer other;
      other.layer = layer;
      other.in_front = true;
      other.boundary = vrml::clip_boundary_of(*scene_, id);
      other.parallel = vrml::is_layout_layer(*scene_, id);
      nodes.others.push_back(other);
    }
    return nodes;
  }

  std::unique_ptr<vrml::SceneGraph> scene_;
  Images images_;
  Geometries geometries_;
  MeshCache meshes_;
  std::unique_ptr<vrml::Execution> execution_;
  std::unique_ptr<vrml::NodeNames> names_;
  std::unique_ptr<RenderScene> render_;
  int steps_ = 0;
};

const std::string kUnitSquare = "Shape { geometry Rectangle2D { size 1 1 } } ";

std::string layer_with(const std::string& fields) {
  return "LayerSet { order [ 0 1 ] layers LayoutLayer { " + fields + " } } ";
}

LayoutValues fields(LayoutAxis x, LayoutAxis y) { return {x, y}; }

void check_close(const glm::dvec4& found, const glm::dvec4& expected) {
  INFO(found.x << ' ' << found.y << ' ' << found.z << ' ' << found.w);
  for (int i = 0; i < 4; ++i) CHECK(found[i] == Approx(expected[i]).margin(1e-6));
}

}  // namespace

TEST_CASE("fills its parent with a Layout of default values") {
  const LayoutRectangle outermost = place_layout({}, {{800, 600}, {400, 300}, {}});
  CHECK(outermost.center == glm::dvec2(0));
  CHECK(outermost.size == glm::dvec2(800, 600));
  CHECK(outermost.scale == glm::dvec2(800, 600));
  // In another Layout, WORLD counts units of the parent, and NONE keeps them.
  const LayoutRectangle inner = place_layout({}, {{800, 600}, {400, 300}, glm::dvec2(20, 10)});
  CHECK(inner.size == glm::dvec2(20, 10));
  CHECK(inner.scale == glm::dvec2(20, 10));
}

TEST_CASE("aligns, moves and sizes rectangles in all units (X3D 36.4.1)") {
  using Unit = LayoutAxis::Unit;
  using Scale = LayoutAxis::Scale;
  const LayoutParent parent{{800, 600}, {400, 300}, glm::dvec2(100, 50)};
  const LayoutRectangle corner = place_layout(fields({-1, 200, 10, Unit::pixel, Unit::pixel, Scale::pixel},
                                                     {1, 0.5, -0.25, Unit::fraction, Unit::fraction, Scale::fraction}),
                                              parent);
  CHECK(corner.size == glm::dvec2(200, 300));
  CHECK(corner.center == glm::dvec2(-300 + 10, 150 - 150));
  CHECK(corner.scale == glm::dvec2(1, 300));
  const LayoutRectangle world = place_layout(
      fields({1, 2, -1, Unit::world, Unit::world, Scale::none}, {0, 3, 1, Unit::world, Unit::world}), parent);
  CHECK(world.size == glm::dvec2(200, 150));
  CHECK(world.center == glm::dvec2(300 - 100, 50));
  CHECK(world.scale == glm::dvec2(100, 50));
}

TEST_CASE("stretches the scale of one direction to that of the other one") {
  using Unit = LayoutAxis::Unit;
  using Scale = LayoutAxis::Scale;
  const LayoutParent parent{{800, 600}, {400, 300}, glm::dvec2(100, 50)};
  const auto scale = [&](Scale x, Scale y) {
    return place_layout(
               fields({0, 0.5, 0, Unit::fraction, Unit::world, x}, {0, 0.5, 0, Unit::fraction, Unit::world, y}), parent)
        .scale;
  };
  CHECK(scale(Scale::stretch, Scale::fraction) == glm::dvec2(300));
  CHECK(scale(Scale::pixel, Scale::stretch) == glm::dvec2(1));
  CHECK(scale(Scale::none, Scale::stretch) == glm::dvec2(100));
  CHECK(scale(Scale::stretch, Scale::stretch) == glm::dvec2(400));
}

TEST_CASE("begins a rectangle with a size in pixels at a whole pixel") {
  LayoutAxis axis;
  axis.size_unit = LayoutAxis::Unit::pixel;
  axis.size = 10;
  const LayoutRectangle odd = place_layout(fields(axis, axis), {{801, 600}, {400.5, 300}, {}});
  CHECK(400.5 + odd.center.x - 5 == 396);
  CHECK(300 + odd.center.y - 5 == 295);
}

TEST_CASE("places content of a LayoutLayer in the rectangle of its Layout, at any size of the picture (X3D 36.4.3)") {
  LayoutWorld world(
      layer_with("layout Layout { align [ \"LEFT\" \"TOP\" ] sizeUnits [ \"FRACTION\" \"PIXEL\" ] "
                 "size [ 0.25 40 ] offsetUnits \"PIXEL\" offset [ 8 -4 ] } children " +
                 kUnitSquare));
  // The default scaleMode of the outermost Layout is FRACTION: the square fills the rectangle.
  check_close(world.pixels_of(world.layer().items.at(0)), {8, 600 - 40 - 4, 200, 40});
  world.sight.pixels = {1200, 501};
  CHECK(world.update());
  check_close(world.pixels_of(world.layer().items.at(0)), {8, 501 - 40 - 4, 300, 40});
  CHECK(world.gathered() == 1);
  CHECK_FALSE(world.update());
}

TEST_CASE("places nested LayoutGroups relative to the rectangle of their parent (X3D 36.4.2)") {
  LayoutWorld world(layer_with(
      "layout Layout { align [ \"RIGHT\" \"BOTTOM\" ] sizeUnits \"PIXEL\" size [ 400 300 ] scaleMode \"PIXEL\" } "
      "children [ Shape { geometry Rectangle2D { size 400 300 } } "
      "LayoutGroup { layout Layout { align [ \"LEFT\" \"TOP\" ] sizeUnits \"FRACTION\" size [ 0.5 0.5 ] "
      "scaleMode \"FRACTION\" } children [ " +
      kUnitSquare +
      "LayoutGroup { layout DEF L Layout { align [ \"RIGHT\" \"BOTTOM\" ] size [ 0.25 0.5 ] offset [ 0 "
      "0.1 ] scaleMode \"FRACTION\" } children " +
      kUnitSquare + " } ] } ]"));
  const auto& items = world.layer().items;
  REQUIRE(items.size() == 3);
  const auto scaled = [&](std::size_t i, double width, double height) {
    glm::dvec4 rectangle = world.pixels_of(items.at(i));
    return glm::dvec4(rectangle.x + rectangle.z / 2 * (1 - width), rectangle.y + rectangle.w / 2 * (1 - height),
                      rectangle.z * width, rectangle.w * height);
  };
  check_close(scaled(0, 400, 300), {400, 0, 400, 300});
  check_close(scaled(1, 1, 1), {400, 150, 200, 150});
  check_close(scaled(2, 1, 1), {550, 165, 50, 75});
  world.send<vrml::MFFloat>("L.set_size", vrml::MFFloat{0.5f, 1.0f});
  CHECK(world.update());
  check_close(scaled(2, 1, 1), {500, 165, 100, 150});
  CHECK(world.gathered() == 1);
}

TEST_CASE("moves a LayoutGroup with a Transform around it, but keeps its size in pixels") {
  LayoutWorld world(
      layer_with("layout Layout { scaleMode \"PIXEL\" } children DEF T Transform { translation 100 50 0 "
                 "scale 3 3 3 children LayoutGroup { layout Layout { sizeUnits \"PIXEL\" size [ 20 10 ] "
                 "scaleMode \"FRACTION\" } children " +
                 kUnitSquare + "} }"));
  check_close(world.pixels_of(world.layer().items.at(0)), {500 - 10, 350 - 5, 20, 10});
  world.send<vrml::SFVec3f>("T.set_translation", {-100, 0, 0});
  CHECK(world.update());
  check_close(world.pixels_of(world.layer().items.at(0)), {300 - 10, 300 - 5, 20, 10});
}

TEST_CASE("fixes a LayoutGroup of a scene to the viewer, in front of the scene (X3D 36.2.1)") {
  LayoutWorld world(
      "Transform { translation 5 5 5 children LayoutGroup { layout Layout { align [ \"LEFT\" \"CENTER\" ] "
      "sizeUnits \"PIXEL\" size [ 60 30 ] scaleMode \"FRACTION\" } children " +
      kUnitSquare + "} }");
  const auto check = [&] {
    const DrawItem& item = world.list().items.at(0);
    CHECK(item.overlay);
    glm::dmat4 world_from_camera(world.sight.orientation);
    world_from_camera[3] = glm::dvec4(world.viewer, 1);
    const glm::dmat4 seen = glm::inverse(world_from_camera) * item.world_from_node;
    const double pixel = pixel_length(world.sight, -seen[3].z);
    CHECK(seen[3].x / pixel == Approx(-world.sight.pixels.x / 2 + 30));
    CHECK(seen[3].y / pixel == Approx(0).margin(1e-6));
    CHECK(glm::length(glm::dvec3(seen[0])) / pixel == Approx(60));
    CHECK(glm::length(glm::dvec3(seen[1])) / pixel == Approx(30));
  };
  check();
  world.viewer = {3, -2, 40};
  world.sight.orientation = glm::dmat3(glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0));
  world.sight.pixels = {640, 480};
  CHECK(world.update());
  check();
  CHECK(world.gathered() == 1);
}

TEST_CASE("clips the content of a LayoutGroup to its Viewport, inside of those around it (X3D 36.4.2, 35.4.4)") {
  LayoutWorld world(layer_with(
      "children LayoutGroup { viewport Viewport { clipBoundary [ 0.25 1 0 0.5 ] } children [ " + kUnitSquare +
      "LayoutGroup { viewport DEF V Viewport { clipBoundary [ 0 0.75 0.25 1 ] } children " + kUnitSquare + "} ] }"));
  const auto inside = [&](std::size_t item, double x, double y) {
    const glm::dvec2 place = (glm::dvec2(x, y) - world.sight.pixels / 2.0) * 2.0 / world.sight.pixels.y;
    for (const std::uint16_t plane : world.layer().items.at(item).clip_planes)
      if (glm::dot(world.layer().clip_planes.at(plane), glm::dvec4(place, 0, 1)) < 0) return false;
    return true;
  };
  CHECK(world.layer().items.at(1).clip_planes.size() == 4);
  CHECK(inside(0, 201, 1));
  CHECK_FALSE(inside(0, 199, 1));
  CHECK_FALSE(inside(0, 201, 301));
  CHECK_FALSE(inside(1, 201, 149));
  CHECK(inside(1, 201, 151));
  CHECK_FALSE(inside(1, 601, 151));
  world.sight.pixels = {400, 200};
  CHECK(world.update());
  CHECK(inside(0, 101, 99));
  CHECK_FALSE(inside(0, 99, 99));
  CHECK_FALSE(inside(0, 101, 101));
  world.send<vrml::MFFloat>("V.set_clipBoundary", vrml::MFFloat{0.0f, 0.5f, 0.25f, 1.0f});
  CHECK(world.update());
  CHECK_FALSE(inside(1, 201, 151));
}

TEST_CASE("keeps the size of a Text with a ScreenFontStyle in points, wherever the viewer is (X3D 36.4.5)") {
  LayoutWorld world(
      "Transform { translation 0 0 -5 scale 7 7 7 children Shape { geometry Text { string \"H\" fontStyle "
      "DEF F ScreenFontStyle { pointSize 30 } } } }");
  const auto pixels_of_em = [&] {
    const DrawItem& item = world.list().items.at(0);
    return item.mesh->font_size * glm::length(glm::dvec3(item.world_from_node[1])) /
           pixel_length(world.sight, world.viewer.z - item.world_from_node[3].z);
  };
  CHECK(pixels_of_em() == Approx(40));  // at 96 pixels per inch
  world.viewer = {20, 3, 80};
  CHECK(world.update());
  CHECK(pixels_of_em() == Approx(40));
  world.sight.pixels = {320, 200};
  world.sight.pixels_per_point = 2;
  CHECK(world.update());
  CHECK(pixels_of_em() == Approx(60));
  world.send<vrml::SFFloat>("F.set_pointSize", 12);
  CHECK(world.update());
  CHECK(pixels_of_em() == Approx(24));
  CHECK(world.gathered() == 1);
}

TEST_CASE("scales ScreenGroups and ScreenFontStyles in parallel projection (X3D 36.4.5, 36.4.6)") {
  LayoutWorld world(
      layer_with("children [ Transform { translation 0.5 0.5 -3 scale 2 5 1 children ScreenGroup { children "
                 "Shape { geometry Rectangle2D { size 16 9 } } } } "
                 "Shape { geometry Text { string \"H\" fontStyle ScreenFontStyle { pointSize 30 } } } ]"));
  const auto& items = world.layer().items;
  const auto check = [&] {
    const double pixel = 2 / std::min(world.sight.pixels.x, world.sight.pixels.y);
    for (int axis = 0; axis < 2; ++axis) {
      CHECK(items.at(0).world_from_node[axis][axis] == Approx(pixel));
      CHECK(items.at(1).mesh->font_size * items.at(1).world_from_node[axis][axis] == Approx(40 * pixel));
    }
  };
  check();
  world.sight.pixels = {500, 1000};
  CHECK(world.update());
  check();
  LayoutWorld parallel("ScreenGroup { children " + kUnitSquare + " }");
  parallel.sight.height = 6;
  CHECK(parallel.update());
  CHECK(parallel.list().items.at(0).world_from_node[0].x == Approx(6.0 / 600));
}

TEST_CASE("collects again if a Text gets a ScreenFontStyle") {
  LayoutWorld world(
      "Shape { geometry DEF T Text { string \"H\" } } Switch { children Shape { geometry Text { fontStyle DEF "
      "F ScreenFontStyle { } } } }");
  CHECK_FALSE(world.list().items.at(0).mesh->in_points);
  world.send<vrml::SFNode>("T.set_fontStyle", world.node("F"));
  CHECK(world.update());
  CHECK(world.list().items.at(0).mesh->in_points);
  CHECK(world.gathered() == 2);
}

TEST_CASE("bounds the depth of nested Layouts and hides content that overflows") {
  std::string deep = kUnitSquare;
  for (int i = 0; i < 200; ++i)
    deep = "LayoutGroup { layout Layout { size 0.9 scaleMode \"FRACTION\" } children " + deep + " } ";
  LayoutWorld world(layer_with("children " + deep));
  CHECK(world.layer().items.size() == 1);
  world.sight.pixels = {400, 400};
  CHECK(world.update());
  LayoutWorld flat(layer_with("children Transform { scale 0 1 1 children LayoutGroup { layout Layout { } children " +
                              kUnitSquare + " } }"));
  CHECK(flat.layer().items.empty());
}

}  // namespace gs::render::layout_test
