// Tests of pictures of the Layout component (X3D 36), pixel by pixel, at several sizes of the picture.
#include "app/loading/world_loader.h"
#include "app/simulation/simulation.h"
#include "tests/app/scratch_folder.h"
#include "tests/render/drawing.h"
#include "vrml/scene/node_names.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>

namespace gs::app::layout_pictures_test {
namespace {

/// World of X3D in a picture of a given size.
class Picture {
 public:
  Picture(const std::string& body, glm::ivec2 size, const ViewStyle& style = {}) : size_(size) {
    LoadedWorld world = load_world(folder_.write(
        "main.x3dv", "#X3D V3.3 utf8\nPROFILE Immersive\nCOMPONENT Layering : 1\nCOMPONENT Layout : 2\n" + body));
    REQUIRE(world.scene);
    for (const Diagnostic& diagnostic : world.diagnostics.entries()) UNSCOPED_INFO(diagnostic.text());
    CHECK(world.diagnostics.entries().empty());
    simulation_ = std::make_unique<Simulation>(std::move(world), size, style);
    simulation_->run(0.1);
    draw();
  }
  template <class T>
  void send(const std::string& name, const std::string& event, T value) {
    vrml::SceneGraph& scene = *simulation_->world().scene;
    const vrml::NodeId node = vrml::NodeNames(scene).find(name);
    REQUIRE(node);
    CHECK(simulation_->execution().send(scene, node, *scene.node(node).type->find_event_in(event),
                                        vrml::FieldValue(std::move(value))));
    simulation_->run(0.2);
    draw();
  }
  [[nodiscard]] const View& view() { return simulation_->look(); }
  /// Returns the colour of a pixel; `x` and `y` count from the lower left corner.
  [[nodiscard]] std::array<int, 3> at(int x, int y) const {
    const auto row = static_cast<std::size_t>(size_.y - 1 - y);
    const std::uint8_t* pixel =
        image_.pixels.data() + (row * image_.width + static_cast<std::size_t>(x)) * image_.components;
    return {pixel[0], pixel[1], pixel[2]};
  }
  /// Returns the box of the pixels with a colour: left, bottom, right and top, with the last pixel.
  [[nodiscard]] std::array<int, 4> box_of(const std::array<int, 3>& color) const {
    std::array<int, 4> box{size_.x, size_.y, -1, -1};
    for (int y = 0; y < size_.y; ++y)
      for (int x = 0; x < size_.x; ++x)
        if (at(x, y) == color)
          box = {std::min(box[0], x), std::min(box[1], y), std::max(box[2], x), std::max(box[3], y)};
    return box;
  }

 private:
  void draw() {
    const render::Camera camera = simulation_->camera();
    const render::RenderList& list = simulation_->look_from(camera);
    drawing_.options.width = size_.x;
    drawing_.options.height = size_.y;
    drawing_.options.headlight = list.navigation.headlight;
    image_ = drawing_.draw(list, camera);
  }

  ScratchFolder folder_;
  glm::ivec2 size_;
  std::unique_ptr<Simulation> simulation_;
  render::testing::Drawing drawing_;
  render::Image image_;
};

constexpr std::array<int, 3> kRed{255, 0, 0}, kGreen{0, 255, 0}, kBlue{0, 0, 255}, kBlack{0, 0, 0};
using Box = std::array<int, 4>;

std::string rectangle(const std::string& color, const std::string& size = "1 1") {
  return "Shape { appearance Appearance { material Material { diffuseColor 0 0 0 emissiveColor " + color +
         " } } geometry Rectangle2D { size " + size + " } } ";
}

// Bar of 24 pixels at the bottom; in it, a square at the right edge and a square in pixels at the left edge.
const std::string kBar =
    "LayerSet { order [ 0 1 ] layers LayoutLayer { layout DEF Bar Layout { align [ \"CENTER\" \"BOTTOM\" ] "
    "sizeUnits [ \"FRACTION\" \"PIXEL\" ] size [ 0.5 24 ] } children [ Transform { translation 0 0 -1 children " +
    rectangle("1 0 0") +
    "} LayoutGroup { layout Layout { align [ \"RIGHT\" \"CENTER\" ] size [ 0.25 0.5 ] scaleMode \"FRACTION\" } "
    "children " +
    rectangle("0 1 0") +
    "} LayoutGroup { layout Layout { align [ \"LEFT\" \"TOP\" ] sizeUnits \"PIXEL\" size [ 10 10 ] offsetUnits "
    "\"PIXEL\" "
    "offset [ 3 -2 ] scaleMode \"PIXEL\" } children " +
    rectangle("0 0 1", "10 10") + "} ] } } ";

}  // namespace

TEST_CASE("draws nested Layouts at the same pixels of a picture as the standard says, at two sizes (X3D 36)") {
  const Picture wide(kBar, {160, 96});
  CHECK(wide.box_of(kRed) == Box{40, 0, 119, 23});
  CHECK(wide.box_of(kGreen) == Box{100, 6, 119, 17});
  CHECK(wide.box_of(kBlue) == Box{43, 12, 52, 21});
  const Picture high(kBar, {96, 200});
  CHECK(high.box_of(kRed) == Box{24, 0, 71, 23});
  CHECK(high.box_of(kGreen) == Box{60, 6, 71, 17});
  CHECK(high.box_of(kBlue) == Box{27, 12, 36, 21});
}

TEST_CASE("follows events for a Layout") {
  Picture picture(kBar, {160, 96});
  picture.send("Bar", "size", vrml::MFFloat{1.0f, 48.0f});
  CHECK(picture.box_of(kRed) == Box{0, 0, 159, 47});
  CHECK(picture.box_of(kGreen) == Box{120, 12, 159, 35});
  picture.send("Bar", "align", vrml::MFString{vrml::SFString("LEFT"), vrml::SFString("TOP")});
  CHECK(picture.box_of(kRed) == Box{0, 48, 159, 95});
}

TEST_CASE("shows an active LayoutLayer in its own rectangle (X3D 36.4.3)") {
  const Picture picture(
      "LayerSet { activeLayer 1 order 1 layers LayoutLayer { layout Layout { align [ \"LEFT\" "
      "\"BOTTOM\" ] size [ 0.5 0.25 ] } children " +
          rectangle("1 0 0") + "} }",
      {160, 96});
  CHECK(picture.box_of(kRed) == Box{0, 0, 79, 23});
}

TEST_CASE("draws a LayoutGroup of a scene in front of it, also with an OrthoViewpoint, and clips it to its Viewport") {
  const std::string scene =
      "Shape { geometry Box { size 50 50 1 } appearance Appearance { material Material { diffuseColor 0 0 0 } } } "
      "LayoutGroup { layout Layout { align [ \"RIGHT\" \"TOP\" ] sizeUnits \"PIXEL\" size [ 60 30 ] } viewport "
      "Viewport { "
      "clipBoundary [ 0 0.75 0 1 ] } children " +
      rectangle("0 1 0") + "}";
  for (const char* viewpoint : {"Viewpoint { position 3 2 20 orientation 0 1 0 0.4 }", "OrthoViewpoint { }"}) {
    const Picture picture(viewpoint + std::string(" ") + scene, {160, 96});
    INFO(viewpoint);
    CHECK(picture.box_of(kGreen) == Box{100, 66, 119, 95});
    CHECK(picture.at(20, 20) == kBlack);
  }
}

TEST_CASE("clips volumes and shapes to all four edges of a Viewport (X3D 35.4.4)") {
  constexpr std::array<int, 3> kWhite{255, 255, 255};
  const std::string volume =
      "Transform { translation 0 0 -5 children VolumeData { dimensions 40 40 1 voxels PixelTexture3D { image [ 1 2 2 2 "
      "255 255 255 255 255 255 255 255 ] } } } ";
  const std::string part = "Viewport { clipBoundary [ 0.125 0.75 0.25 0.875 ] ";
  const std::string layout = "LayoutGroup { viewport " + part + "} children ";
  for (const char* viewpoint : {"Viewpoint { }", "OrthoViewpoint { }", "Viewpoint { orientation 0.6 0.8 0 0.2 }"}) {
    INFO(viewpoint);
    const std::string before = "NavigationInfo { headlight FALSE } " + std::string(viewpoint) + " ";
    CHECK(Picture(before + layout + volume + "}", {160, 96}).box_of(kWhite) == Box{20, 24, 119, 83});
    CHECK(Picture(before + part + "children " + volume + "}", {160, 96}).box_of(kWhite) == Box{20, 24, 119, 83});
    CHECK(Picture(before + part + "children " + rectangle("0 1 0", "90 90") + "}", {160, 96}).box_of(kGreen) ==
          Box{20, 24, 119, 83});
  }
}

TEST_CASE("draws Text with a ScreenFontStyle with the same height in pixels at any distance (X3D 36.4.5)") {
  const auto height = [](const std::string& where, glm::ivec2 size, double pixels_per_point) {
    ViewStyle style;
    style.pixels_per_point = pixels_per_point;
    const Picture picture(where +
                              " Transform { translation -0.2 0 0 scale 3 3 3 children Shape { appearance Appearance { "
                              "material Material { "
                              "diffuseColor 0 0 0 emissiveColor 0 1 0 } } geometry Text { string \"H\" fontStyle "
                              "ScreenFontStyle { family "
                              "\"SANS\" pointSize 36 } } } }",
                          size, style);
    const Box box = picture.box_of(kGreen);
    return box[3] - box[1] + 1;
  };
  const int usual = height("Viewpoint { }", {160, 96}, render::kUsualPixelsPerPoint);
  CHECK(usual > 48 * 0.6);  // capital letters of 48 pixels per em
  CHECK(usual < 48 * 0.85);
  CHECK(std::abs(height("Viewpoint { position 1 2 70 }", {160, 96}, render::kUsualPixelsPerPoint) - usual) <= 1);
  CHECK(std::abs(height("OrthoViewpoint { }", {200, 180}, render::kUsualPixelsPerPoint) - usual) <= 1);
  CHECK(std::abs(height("Viewpoint { }", {200, 180}, 2 * render::kUsualPixelsPerPoint) - 2 * usual) <= 2);
}

TEST_CASE("places Layouts for a saved picture of another size, and then for the viewport again") {
  Picture picture(kBar, {160, 96});
  const View& view = picture.view();
  const auto width = [&] { return view.list->layers.at(0).list->items.at(0).world_from_node[0].x; };
  const double before = width();
  CHECK(before == Approx(80 * 2.0 / 96));
  const render::Camera camera = camera_of(view.navigation.pose);
  lay_out(view, camera, {400, 100});
  CHECK(width() == Approx(200 * 2.0 / 100));
  lay_out(view, camera, view.size);
  CHECK(width() == before);
}

}  // namespace gs::app::layout_pictures_test
