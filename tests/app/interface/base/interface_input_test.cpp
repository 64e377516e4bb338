#include "app/interface/base/interface_input.h"
#include "base/noncopyable.h"

#include <catch2/catch.hpp>

#include <imgui.h>

#include <string>
#include <vector>

namespace gs::app::interface_input_test {

using Kind = WindowEvent::Kind;

// Key codes as in GLFW and in the backend of Dear ImGui.
constexpr int kControl = 341, kLeft = 263, kBackspace = 259, kEnter = 257;

WindowEvent key(Kind kind, int code, Key key = Key::unknown) {
  WindowEvent event;
  event.kind = kind;
  event.code = code;
  event.key = key;
  return event;
}

void add_key(std::vector<WindowEvent>& events, int code) {
  events.push_back(key(Kind::key_down, code));
  events.push_back(key(Kind::key_up, code));
}
void add_text(std::vector<WindowEvent>& events, const std::string& text) {
  for (const char c : text) {
    const int code = c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c;
    events.push_back(key(Kind::key_down, code));
    events.push_back(key(Kind::character, c));
    events.push_back(key(Kind::key_up, code));
  }
}
void add_with_control(std::vector<WindowEvent>& events, char letter) {
  events.push_back(key(Kind::key_down, kControl, Key::control));
  add_key(events, letter);
  events.push_back(key(Kind::key_up, kControl, Key::control));
}

/// Text field and button in a Dear ImGui window without a display.
struct Form : NonCopyable {
  Form() {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = {400, 300};
    io.DeltaTime = 1 / 60.0f;
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    const std::pair<ImGuiKey, int> keys[] = {{ImGuiKey_A, 'A'},
                                             {ImGuiKey_V, 'V'},
                                             {ImGuiKey_LeftArrow, kLeft},
                                             {ImGuiKey_Backspace, kBackspace},
                                             {ImGuiKey_Enter, kEnter}};
    for (const auto& [name, code] : keys) io.KeyMap[name] = code;
    ImGui::SetClipboardText("pasted");
    for (int i = 0; i < 3; ++i) frame({});  // until the field has the focus
    REQUIRE(io.WantTextInput);
  }
  ~Form() { ImGui::DestroyContext(); }

  void frame(const std::vector<WindowEvent>& events, bool text_waits = false) {
    input.add(events);
    input.apply(ImGui::GetIO(), text_waits);
    ImGui::NewFrame();
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({400, 300});
    ImGui::Begin("form", nullptr, ImGuiWindowFlags_NoTitleBar);
    if (frames++ == 0) ImGui::SetKeyboardFocusHere();
    entered = ImGui::InputText("##text", text, sizeof text, ImGuiInputTextFlags_EnterReturnsTrue) || entered;
    ImGui::SetCursorPos({100, 100});
    pressed += ImGui::Button("button", {100, 50}) ? 1 : 0;
    ImGui::End();
    ImGui::EndFrame();
  }
  /// Handles the events of one slow frame, and the frames that follow.
  void at_once(const std::vector<WindowEvent>& events) {
    frame(events);
    for (int i = 0; i < 1000 && input.waiting(); ++i) frame({});
    CHECK_FALSE(input.waiting());
    frame({});
  }

  InterfaceInput input;
  char text[256] = {};
  int frames = 0, pressed = 0;
  bool entered = false;
};

TEST_CASE("pastes on Ctrl+V also if released within a frame, and selects all on Ctrl+A") {
  Form form;
  std::vector<WindowEvent> events;
  add_text(events, "old");
  add_with_control(events, 'A');
  add_with_control(events, 'V');
  form.at_once(events);
  CHECK(std::string(form.text) == "pasted");
  CHECK_FALSE(ImGui::GetIO().KeyCtrl);
}

TEST_CASE("keeps the order of text typed within a frame") {
  Form form;
  std::vector<WindowEvent> events;
  add_text(events, "abd");
  add_key(events, kLeft);
  add_text(events, "c");
  add_key(events, kBackspace);
  add_text(events, "xx");
  add_key(events, kEnter);
  form.at_once(events);
  CHECK(std::string(form.text) == "abxxd");
  CHECK(form.entered);
}

TEST_CASE("holds text until its field has the focus") {
  Form form;
  std::vector<WindowEvent> events;
  add_text(events, "a");
  form.frame(events, true);
  form.frame({}, true);
  CHECK(std::string(form.text).empty());
  CHECK(form.input.waiting());
  form.at_once({});
  CHECK(std::string(form.text) == "a");
}

TEST_CASE("clicks at the position of the press, also for two clicks within a frame") {
  Form form;
  const auto at = [](Kind kind, float x, float y) {
    WindowEvent event;
    event.kind = kind;
    event.pointer = {x, y};
    return event;
  };
  form.frame({at(Kind::pointer, 150, 120)});
  std::vector<WindowEvent> events;
  for (int i = 0; i < 2; ++i) {
    events.push_back(at(Kind::button_down, 150, 120));
    events.push_back(at(Kind::button_up, 150, 120));
  }
  events.push_back(at(Kind::pointer, 10, 290));
  form.at_once(events);
  CHECK(form.pressed == 2);
  CHECK(ImGui::GetIO().MousePos.x == 10);
  form.at_once({at(Kind::pointer_left, 0, 0)});
  CHECK(ImGui::GetIO().MousePos.x < -1e6f);
}

TEST_CASE("releases all keys when the window loses the focus") {
  Form form;
  form.frame({key(Kind::key_down, kControl, Key::control)});
  CHECK(ImGui::GetIO().KeyCtrl);
  WindowEvent lost;
  lost.kind = Kind::focus_lost;
  form.at_once({lost});
  CHECK_FALSE(ImGui::GetIO().KeyCtrl);
  CHECK_FALSE(ImGui::GetIO().KeysDown[kControl]);
}

}  // namespace gs::app::interface_input_test
