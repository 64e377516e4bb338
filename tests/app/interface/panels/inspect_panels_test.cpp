// Tests of panels that inspect a world, without a display.
#include "app/interface/panels/inspect_panels.h"
#include "base/noncopyable.h"

#include "app/interface/ui_overlay.h"
#include "tests/app/one_world.h"

#include <catch2/catch.hpp>

#include <imgui.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gs::app::inspect_panels_test {

using namespace sessions;

class NoWindow final : public InterfaceBackend {
 public:
  void begin() override {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {1000, 700};
    io.DeltaTime = 1 / 60.0f;
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsAlpha8(&pixels, &width, &height);
    // Key codes as in GLFW.
    io.KeyMap[ImGuiKey_Enter] = 257;
    io.KeyMap[ImGuiKey_Escape] = 256;
    io.KeyMap[ImGuiKey_DownArrow] = 264;
    io.KeyMap[ImGuiKey_UpArrow] = 265;
    io.KeyMap[ImGuiKey_RightArrow] = 262;
    io.KeyMap[ImGuiKey_LeftArrow] = 263;
  }
  void begin_frame() override {}
  void fonts_changed() override {}
  void draw() override {}
};

/// World with its panels, without a window.
struct Screen : OneWorld, NonCopyable {
  explicit Screen(const std::string& body) : OneWorld(body) {
    session.add_extension(inspection);
    model.inspection = &inspection;
    model.has_world = true;
    draw();
  }
  ~Screen() { session.remove_extension(inspection); }

  UiActions draw(const std::vector<WindowEvent>& done = {}) {
    now += 0.02;
    interface.begin_frame(now, done);
    (void)interface.picture_area({1000, 700});
    frame = session.step(now, input_of({}));
    inspection.prepare(session, frame.pictures, now);
    UiActions actions = interface.build(model);
    ImGui::Render();
    while (interface.has_input_left()) {
      now += 0.02;
      interface.begin_frame(now, {});
      (void)interface.build(model);
      ImGui::Render();
    }
    return actions;
  }
  void open(Action panel) {
    interface.show_panel(panel);
    for (int i = 0; i < 4; ++i) draw();
  }
  void click(float x, float y, bool twice = false) {
    draw({pointer(Kind::pointer, x, y)});
    for (int i = 0; i < (twice ? 2 : 1); ++i) {
      draw({pointer(Kind::button_down, x, y)});
      draw({pointer(Kind::button_up, x, y)});
    }
    draw();
  }
  // Clicks down a column until a click has an effect.
  bool click_until(float x, float top, float bottom, const std::function<bool()>& done) {
    for (float y = top; y < bottom && !done(); y += 7) click(x, y);
    return done();
  }
  void press(int code) {
    WindowEvent event;
    event.code = code;
    event.kind = Kind::key_down;
    draw({event});
    event.kind = Kind::key_up;
    draw({event});
  }
  void type(const std::string& text) {
    for (const char letter : text) {
      WindowEvent event;
      event.kind = Kind::character;
      event.code = letter;
      draw({event});
    }
  }
  [[nodiscard]] std::string chosen() const { return inspection.selected() ? label_of(inspection.selected()) : ""; }

  double now = kStart;
  UiModel model;
  UiOverlay interface { std::make_unique<NoWindow>(), 1 };
  Inspection inspection;
};

TEST_CASE("selects lines of the scene tree by click and arrow keys, which also open and close them") {
  Screen screen("DEF First Group { children [ DEF Inner Shape { geometry Box {} } ] } DEF Second Transform {}");
  screen.open(Action::scene_tree);
  CHECK(screen.inspection.outline().size() == 2);
  REQUIRE(screen.click_until(120, 60, 300, [&] { return screen.chosen() == "First"; }));
  screen.press(264);
  CHECK(screen.chosen() == "Second");
  screen.press(265);
  screen.press(262);
  CHECK(screen.inspection.outline().size() == 3);
  screen.press(262);
  CHECK(screen.chosen() == "Inner");
  screen.press(263);
  screen.press(263);
  CHECK(screen.inspection.outline().size() == 2);
}

TEST_CASE("finds the text that is typed into the search") {
  Screen screen("DEF First Group { children [ DEF Inner Shape { geometry Box {} } ] } DEF Second Transform {}");
  screen.open(Action::scene_tree);
  REQUIRE(screen.click_until(60, 30, 120, [] { return ImGui::GetIO().WantTextInput; }));
  screen.type("inn");
  screen.draw();
  screen.draw();
  CHECK(screen.chosen() == "Inner");
  CHECK(screen.inspection.outline().size() == 3);
}

TEST_CASE("runs entered lines in the console, and recalls them") {
  Screen screen("DEF S Script { field SFFloat x 4 url \"javascript: ;\" }");
  screen.open(Action::script_console);
  screen.inspection.select({screen.document->world.scene.get(), screen.document->world.scene->roots()[0]}, false);
  bool found = false;
  for (float y = 690; y > 500 && !found; y -= 7) {
    screen.click(500, y);
    found = ImGui::GetIO().WantTextInput;
  }
  REQUIRE(found);
  screen.type("x*x");
  screen.press(257);
  screen.draw();
  REQUIRE_FALSE(screen.inspection.console().lines().empty());
  CHECK(screen.inspection.console().lines().back().text == "16");
  screen.press(265);
  screen.press(257);
  screen.draw();
  CHECK(screen.inspection.console().lines().size() == 4);
}

TEST_CASE("draws all panels for every field type, and without a world") {
  Screen screen(
      "DEF All Script { field SFBool a TRUE field SFColor b 1 0 0 field SFImage d 1 1 1 0 field SFNode e NULL "
      "eventIn SFRotation f eventOut MFVec3f g field MFString h [ \"x\" ] exposedField MFColor i 1 1 1 } "
      "DEF T Transform { children Shape {} } DEF M Material {} DEF I IndexedFaceSet { coordIndex [ 0 1 2 -1 ] } "
      "DEF C TimeSensor { loop TRUE } DEF P PositionInterpolator {} ROUTE C.fraction_changed TO P.set_fraction");
  for (const Action panel :
       {Action::scene_tree, Action::routes, Action::inspector, Action::streams, Action::script_console})
    screen.open(panel);
  const vrml::SceneGraph& scene = *screen.document->world.scene;
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    screen.inspection.select({&scene, scene.nodes().id_at(i)}, true);
    // The arrow before a list opens it.
    for (float y = 110; y < 400; y += 30) screen.click(720, y);
  }
  screen.inspection.select({}, false);
  screen.model.inspection = nullptr;
  screen.model.has_world = false;
  (void)screen.draw();
  CHECK(screen.inspection.world());
}

}  // namespace gs::app::inspect_panels_test
