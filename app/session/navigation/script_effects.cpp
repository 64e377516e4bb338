#include "app/session/navigation/script_effects.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

namespace gs::app {
namespace {

/// Navigation mode of Contact or Cosmo Player that VRML97 does not have.
struct OtherMode {
  std::string_view name;
  NavigationMode mode;
};
constexpr OtherMode kOtherModes[] = {
    {"SLIDE", NavigationMode::pan},    {"PAN", NavigationMode::pan},      {"GAME", NavigationMode::walk},
    {"SPIN", NavigationMode::examine}, {"JUMP", NavigationMode::look_at}, {"BEAMTO", NavigationMode::look_at},
};

std::optional<NavigationMode> mode_named(std::string_view name) {
  for (const NavigationModeRow& row : navigation_modes())
    if (!row.type.empty() && row.type == name) return row.mode;
  for (const OtherMode& other : kOtherModes)
    if (other.name == name) return other.mode;
  return std::nullopt;
}

/// Key of which the code of Windows differs from the code here.
struct KeyCodeRow {
  Key key;
  int code;
};
constexpr KeyCodeRow kKeyCodes[] = {
    {Key::escape, 27}, {Key::enter, 13},   {Key::tab, 9},        {Key::left, 37}, {Key::right, 39}, {Key::up, 38},
    {Key::down, 40},   {Key::page_up, 33}, {Key::page_down, 34}, {Key::home, 36}, {Key::end, 35},   {Key::f1, 112},
    {Key::f2, 113},    {Key::f3, 114},     {Key::f4, 115},       {Key::f5, 116},  {Key::f6, 117},   {Key::f11, 122},
    {Key::f12, 123},   {Key::shift, 16},   {Key::control, 17},   {Key::alt, 18},  {Key::plus, 187}, {Key::minus, 189},
};

// Returns the key code of Windows; 0 if it is unknown.
int code_of(const WindowEvent& event) {
  const auto* const row =
      std::find_if(std::begin(kKeyCodes), std::end(kKeyCodes), [&](const KeyCodeRow& one) { return one.key == event.key; });
  if (row != std::end(kKeyCodes)) return row->code;
  constexpr int kAscii = 128;
  const int code = event.key == Key::unknown ? event.code : static_cast<int>(event.key);
  return code > 0 && code < kAscii ? code : 0;
}

bool may_cancel(const WindowEvent& event) {
  const bool reserved = event.control || event.alt || event.key == Key::escape || event.key == Key::tab ||
                        (event.key >= Key::f1 && event.key <= Key::f12);
  return event.kind == WindowEvent::Kind::key_down && !reserved;
}

int button_of(MouseButton button) {
  constexpr int kLeft = 1, kRight = 2, kMiddle = 4;
  return button == MouseButton::left ? kLeft : button == MouseButton::right ? kRight : kMiddle;
}

// Converts an event of the window; returns nullopt if Contact has no such event.
std::optional<vrml::BrowserInput> input_of(const WindowEvent& event, const Viewport& place) {
  using Kind = WindowEvent::Kind;
  vrml::BrowserInput input;
  input.alt = event.alt;
  input.control = event.control;
  input.shift = event.shift;
  input.client = place.inside(event.pointer);
  const bool is_inside =
      input.client.x >= 0 && input.client.y >= 0 && input.client.x < place.size().x && input.client.y < place.size().y;
  switch (event.kind) {
    case Kind::key_down:
    case Kind::key_up:
      input.kind = event.kind == Kind::key_down ? vrml::BrowserInputKind::keydown : vrml::BrowserInputKind::keyup;
      input.key = code_of(event);
      return input.key != 0 ? std::optional(input) : std::nullopt;
    case Kind::button_down:
    case Kind::button_up:
      input.kind =
          event.kind == Kind::button_down ? vrml::BrowserInputKind::mousedown : vrml::BrowserInputKind::mouseup;
      input.button = button_of(event.button);
      return is_inside ? std::optional(input) : std::nullopt;
    case Kind::pointer:
      input.kind = vrml::BrowserInputKind::mousemove;
      return is_inside ? std::optional(input) : std::nullopt;
    default:
      return std::nullopt;
  }
}

}  // namespace

void tell_viewport(Document& document, const View& leader, const Viewport& place) {
  const Navigation& navigation = leader.navigation;
  document.runtime->execution().browser().set_view(
      {glm::dvec2(place.size()), std::string(row_of(navigation.mode).type), double{navigation.speed}});
}

bool apply_script_requests(View& leader) {
  vrml::WorldBrowser& browser = leader.document->runtime->execution().browser();
  bool any = false;
  if (const auto name = browser.take_mode())
    if (const auto mode = mode_named(*name); mode && *mode != leader.navigation.mode) {
      leader.navigation = with_mode(leader.navigation, *mode);
      any = true;
    }
  const auto move = browser.take_move();
  if (!move) return any;
  const double height = leader.navigation.pose.height;
  leader.navigation.transition.reset();
  leader.navigation.body = {};
  leader.navigation.pose = pose_of(*move, leader.navigation.pose.field_of_view);
  leader.navigation.pose.height = height;
  leader.document->runtime->execution().viewer().jump();
  return true;
}

bool send_to_scripts(View& view, const Viewport& place, const WindowEvent& event, double now) {
  if (!view.document || !view.document->runtime || !view.document->runtime->has_started()) return false;
  vrml::WorldBrowser& browser = view.document->runtime->execution().browser();
  if (event.kind == WindowEvent::Kind::focus_lost) {
    browser.release_keys();
    return false;
  }
  const auto input = input_of(event, place);
  if (!input) return false;
  if (browser.wants(input->kind)) (void)view.document->runtime->step(now);
  return browser.send_input(*input) && may_cancel(event);
}

}  // namespace gs::app
