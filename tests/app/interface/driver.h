#pragma once

#include "app/viewer/viewer_controller.h"
#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <imgui.h>
#include <glm/vec2.hpp>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

/// Simulated user of the interface, without a window. Reads the screen from the draw commands, so only drawn words can
/// be found and clicked.
namespace gs::app::driver {

/// Returns the code of a key in GLFW.
inline int code_of(Key key) {
  static const std::map<Key, int> kCodes = {
      {Key::escape, 256}, {Key::enter, 257},     {Key::tab, 258},     {Key::right, 262}, {Key::left, 263},
      {Key::down, 264},   {Key::up, 265},        {Key::page_up, 266}, {Key::home, 268},  {Key::end, 269},
      {Key::f1, 290},     {Key::f2, 291},        {Key::f3, 292},      {Key::f4, 293},    {Key::f5, 294},
      {Key::f6, 295},     {Key::page_down, 267}, {Key::control, 341}, {Key::shift, 340}, {Key::alt, 342},
      {Key::plus, 61},    {Key::minus, 45},      {Key::f11, 300},
  };
  const auto found = kCodes.find(key);
  return found == kCodes.end() ? static_cast<int>(key) : found->second;
}

/// Window substitute with a size and frames of 1/60 s.
class NoWindow final : public InterfaceBackend {
 public:
  explicit NoWindow(const glm::vec2& size) : size_(size) {}
  void begin() override {
    ImGuiIO& io = ImGui::GetIO();
    const std::pair<ImGuiKey, int> keys[] = {
        {ImGuiKey_Tab, 258},       {ImGuiKey_LeftArrow, 263}, {ImGuiKey_RightArrow, 262}, {ImGuiKey_UpArrow, 265},
        {ImGuiKey_DownArrow, 264}, {ImGuiKey_Enter, 257},     {ImGuiKey_Escape, 256},     {ImGuiKey_Backspace, 259},
        {ImGuiKey_Delete, 261},    {ImGuiKey_Home, 268},      {ImGuiKey_End, 269},        {ImGuiKey_A, 'A'},
        {ImGuiKey_C, 'C'},         {ImGuiKey_V, 'V'},         {ImGuiKey_X, 'X'}};
    for (const auto& [name, code] : keys) io.KeyMap[name] = code;
  }
  void begin_frame() override {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {size_.x, size_.y};
    io.DeltaTime = 1 / 60.0f;
  }
  void fonts_changed() override {}
  void draw() override {}

 private:
  glm::vec2 size_;
};

/// Character on the screen.
struct SeenCharacter {
  ImWchar character;
  float left, right, top, bottom;
};

/// Returns the characters of a frame in drawing order.
inline std::vector<SeenCharacter> seen_characters() {
  std::vector<SeenCharacter> seen;
  const ImDrawData* data = ImGui::GetDrawData();
  if (!data) return seen;
  const auto number = [](float place) {
    return static_cast<std::int64_t>(std::llround(static_cast<double>(place) * 65536));
  };
  using Corner = std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t>;
  std::map<Corner, ImWchar> glyphs;
  for (const ImFontGlyph& glyph : ImGui::GetFont()->Glyphs)
    if (glyph.Visible)
      glyphs.try_emplace({number(glyph.U0), number(glyph.V0), number(glyph.U1), number(glyph.V1)},
                         static_cast<ImWchar>(glyph.Codepoint));
  for (int i = 0; i < data->CmdListsCount; ++i) {
    const ImDrawList& list = *data->CmdLists[i];
    for (const ImDrawCmd& command : list.CmdBuffer) {
      if (command.UserCallback) continue;
      // A glyph has two triangles on four consecutive vertices.
      for (unsigned at = 0; at + 6 <= command.ElemCount;) {
        const ImDrawIdx* index = &list.IdxBuffer[static_cast<int>(command.IdxOffset + at)];
        const auto first = static_cast<int>(index[0] + command.VtxOffset);
        const bool quad = index[1] == index[0] + 1 && index[2] == index[0] + 2 && index[3] == index[0] &&
                          index[4] == index[0] + 2 && index[5] == index[0] + 3;
        if (!quad) {
          at += 3;
          continue;
        }
        const ImDrawVert &a = list.VtxBuffer[first], &c = list.VtxBuffer[first + 2];
        const auto found = glyphs.find({number(a.uv.x), number(a.uv.y), number(c.uv.x), number(c.uv.y)});
        const ImVec4& clip = command.ClipRect;
        const float x = (a.pos.x + c.pos.x) / 2, y = (a.pos.y + c.pos.y) / 2;
        if (found != glyphs.end() && x >= clip.x && x < clip.z && y >= clip.y && y < clip.w)
          seen.push_back({found->second, a.pos.x, c.pos.x, a.pos.y, c.pos.y});
        at += 6;
      }
    }
  }
  return seen;
}

class Driver final : public WindowOperations {
 public:
  explicit Driver(ViewerControllerOptions options = {}, const glm::ivec2& size = {1000, 700}, LoadOptions load = {})
      : size_(size), controller_(std::move(options), std::move(load), std::make_unique<NoWindow>(size), *this, [] {}) {
    settle();
  }

  ViewerController& controller() { return controller_; }
  Session& session() { return controller_.session(); }
  const Frame& frame() const { return frame_; }
  /// Newest action of each kind since the last call.
  const UiActions& actions() const { return actions_; }
  /// Measured times of the picture, as in the model.
  PictureMeasures& measures() { return measures_; }
  bool closed() const { return closed_; }
  int full_screens() const { return full_screens_; }
  Viewport picture() { return controller_.ui().picture_area(size_); }
  /// Sets a function that changes the model before it is shown, for states that no test session has.
  void set_model(std::function<void(UiModel&)> change) { change_model_ = std::move(change); }

  /// Shows a running world in the active viewport.
  void show_world(const std::string& body, const std::string& path = "test.wrl") {
    LoadedWorld world = world_of(body);
    world.path = path;
    auto document = hold_world(std::move(world));
    begin_world(*document, time_);
    session().readers().show(std::move(document));
    settle();
  }

  /// Runs one round of the window's loop.
  void step(std::vector<WindowEvent> events = {}) {
    for (WindowEvent& event : events) {
      event.time = time_;
      if (event.kind != WindowEvent::Kind::character) event.pointer = pointer_;
    }
    time_ += 1 / 60.0;
    SessionInput input;
    input.area = picture();
    controller_.ui().begin_frame(time_, events);
    input.events = controller_.take(events);
    (void)controller_.take_chosen_files();
    frame_ = session().step(time_, input);
    (void)controller_.tell(frame_);
    controller_.inspection().prepare(session(), frame_.pictures, time_);
    UiModel model = controller_.model(frame_, measures_);
    if (change_model_) change_model_(model);
    const UiActions actions = controller_.ui().build(model);
    controller_.ui().draw();
    controller_.apply(actions);
    if (actions.run) actions_.run = actions.run;
    if (actions.open) actions_.open = actions.open;
    if (actions.file) actions_.file = actions.file;
    if (actions.viewpoint) actions_.viewpoint = actions.viewpoint;
    if (actions.mode) actions_.mode = actions.mode;
    if (actions.look) actions_.look = actions.look;
  }
  /// Runs frames until the interface no longer changes.
  void settle() {
    for (int i = 0; i < 4 || controller_.ui().has_input_left(); ++i) step();
  }
  /// Runs frames until `so` returns true. Returns false after a time limit.
  bool wait_for(const std::function<bool()>& so) {
    for (int i = 0; i < 5000; ++i) {
      step();
      if (so()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  /// Advances time by `seconds`.
  void wait(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 60); ++i) step();
  }

  /// Returns all words on the screen in drawing order, separated by blanks within a line.
  std::string screen() const {
    std::string text;
    for (const auto& [word, place] : words()) text += (text.empty() ? "" : " ") + word;
    return text;
  }
  /// Finds a text on the screen, the frontmost first, and returns its centre.
  std::optional<glm::vec2> find(std::string_view text) const {
    const std::string wanted = without_blanks(text);
    const std::vector<SeenCharacter> seen = seen_characters();
    std::string all;
    for (const SeenCharacter& one : seen) all += one.character < 0x80 ? static_cast<char>(one.character) : '?';
    std::optional<glm::vec2> result;
    for (std::size_t at = all.find(wanted); at != std::string::npos; at = all.find(wanted, at + 1)) {
      const SeenCharacter &first = seen[at], &last = seen[at + wanted.size() - 1];
      if (std::abs(first.top - last.top) > last.bottom - last.top + 8) continue;  // on two lines
      // The last drawn match is in front, because lists and menus cover earlier texts.
      result = glm::vec2((first.left + last.right) / 2, (first.top + last.bottom) / 2);
    }
    return result;
  }
  bool sees(std::string_view text) const { return find(text).has_value(); }

  void point(const glm::vec2& place) {
    pointer_ = place;
    step({event(WindowEvent::Kind::pointer)});
    step();
  }
  void click(const glm::vec2& place, MouseButton button = MouseButton::left) {
    point(place);
    step({event(WindowEvent::Kind::button_down, button)});
    step({event(WindowEvent::Kind::button_up, button)});
    settle();
  }
  /// Clicks a text on the screen.
  void click(std::string_view text, MouseButton button = MouseButton::left) {
    INFO("\"" << text << "\" on the screen: " << screen());
    const auto place = find(text);
    REQUIRE(place);
    click(*place, button);
  }
  void drag(const glm::vec2& from, const glm::vec2& to) {
    point(from);
    step({event(WindowEvent::Kind::button_down)});
    for (int i = 1; i <= 4; ++i) {
      pointer_ = from + (to - from) * (static_cast<float>(i) / 4);
      step({event(WindowEvent::Kind::pointer)});
    }
    step({event(WindowEvent::Kind::button_up)});
    settle();
  }
  void drop(const glm::vec2& place, const std::vector<std::string>& paths) {
    pointer_ = place;
    WindowEvent dropped = event(WindowEvent::Kind::drop);
    dropped.paths = paths;
    step({dropped});
    settle();
  }
  /// Presses the button without a release.
  void hold(const glm::vec2& place) {
    point(place);
    step({event(WindowEvent::Kind::button_down)});
  }
  /// Turns the wheel by notches; negative is towards the user.
  void turn_wheel(const glm::vec2& place, float notches) {
    point(place);
    WindowEvent turned = event(WindowEvent::Kind::wheel);
    turned.wheel = notches;
    step({turned});
    settle();
  }
  /// Presses and releases a key with modifiers.
  void press(Key key, bool control = false, bool shift = false, bool alt = false) {
    std::vector<WindowEvent> events;
    const std::pair<Key, bool> held[] = {{Key::control, control}, {Key::shift, shift}, {Key::alt, alt}};
    for (const auto& [one, is_held] : held)
      if (is_held) events.push_back(key_event(WindowEvent::Kind::key_down, one, control, shift, alt));
    events.push_back(key_event(WindowEvent::Kind::key_down, key, control, shift, alt));
    events.push_back(key_event(WindowEvent::Kind::key_up, key, control, shift, alt));
    for (const auto& [one, is_held] : held)
      if (is_held) events.push_back(key_event(WindowEvent::Kind::key_up, one, false, false, false));
    step(events);
    settle();
  }
  void type(std::string_view text) {
    std::vector<WindowEvent> events;
    for (const char c : text) {
      const char upper = c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
      events.push_back(key_event(WindowEvent::Kind::key_down, letter_key(upper), false, false, false));
      WindowEvent character = event(WindowEvent::Kind::character);
      character.code = c;
      events.push_back(character);
      events.push_back(key_event(WindowEvent::Kind::key_up, letter_key(upper), false, false, false));
    }
    step(events);
    settle();
  }

  /// Types letters that are not on the keyboard.
  void type_letters(std::u32string_view text) {
    std::vector<WindowEvent> events;
    for (const char32_t letter : text) {
      events.push_back(event(WindowEvent::Kind::character));
      events.back().code = static_cast<int>(letter);
    }
    step(events);
    settle();
  }
  /// Returns the x coordinate of the letter on the screen. If it occurs several times, returns the first one.
  std::optional<float> place_of(char32_t letter) const {
    for (const SeenCharacter& one : seen_characters())
      if (one.character == static_cast<ImWchar>(letter)) return one.left;
    return std::nullopt;
  }

  void toggle_full_screen() override { ++full_screens_; }
  void close() override { closed_ = true; }

 private:
  static std::string without_blanks(std::string_view text) {
    std::string result;
    for (const char c : text)
      if (c != ' ') result += c;
    return result;
  }
  static std::vector<std::pair<std::string, glm::vec2>> words() {
    std::vector<std::pair<std::string, glm::vec2>> result;
    const SeenCharacter* before = nullptr;
    const std::vector<SeenCharacter> seen = seen_characters();
    for (const SeenCharacter& one : seen) {
      const bool goes_on = before && one.left >= before->left && one.left - before->right < 3 &&
                           std::abs((one.top + one.bottom) - (before->top + before->bottom)) < 24;
      if (!goes_on) result.push_back({"", {one.left, one.top}});
      result.back().first += one.character < 0x80 ? static_cast<char>(one.character) : '?';
      before = &one;
    }
    return result;
  }
  static WindowEvent event(WindowEvent::Kind kind, MouseButton button = MouseButton::left) {
    WindowEvent result;
    result.kind = kind;
    result.button = button;
    return result;
  }
  static WindowEvent key_event(WindowEvent::Kind kind, Key key, bool control, bool shift, bool alt) {
    WindowEvent result = event(kind);
    result.key = key;
    result.code = code_of(key);
    result.control = control;
    result.shift = shift;
    result.alt = alt;
    return result;
  }

  glm::ivec2 size_;
  glm::vec2 pointer_{-1, -1};
  double time_ = 1000;
  bool closed_ = false;
  int full_screens_ = 0;
  std::function<void(UiModel&)> change_model_;
  UiActions actions_;
  PictureMeasures measures_;
  Frame frame_;
  ViewerController controller_;
};

}  // namespace gs::app::driver
