#include "app/session/navigation/key_input.h"

#include <algorithm>
#include <iterator>
#include <optional>

namespace gs::app {
namespace {

/// Key that types no character: its value in actionKeyPress, or the character that X3D gives it, or its modifier.
struct KeyMeaning {
  Key key;
  int action = 0;
  char32_t character = 0;
  vrml::ModifierKey modifier = vrml::ModifierKey::none;
};
constexpr KeyMeaning kKeyMeanings[] = {
    {Key::f1, 1},
    {Key::f2, 2},
    {Key::f3, 3},
    {Key::f4, 4},
    {Key::f5, 5},
    {Key::f6, 6},
    {Key::f11, 11},
    {Key::f12, 12},
    {Key::home, 13},
    {Key::end, 14},
    {Key::page_up, 15},
    {Key::page_down, 16},
    {Key::up, 17},
    {Key::down, 18},
    {Key::left, 19},
    {Key::right, 20},
    {Key::enter, 0, 10},
    {Key::tab, 0, 9},
    {Key::escape, 0, 27},
    {Key::shift, 0, 0, vrml::ModifierKey::shift},
    {Key::alt, 0, 0, vrml::ModifierKey::alt},
    {Key::control, 0, 0, vrml::ModifierKey::control},
};

// Key codes of GLFW for keys that have no shortcuts.
constexpr int kBackspaceCode = 259, kDeleteCode = 261, kF7Code = 296, kF10Code = 299;

KeyMeaning meaning_of(const WindowEvent& event) {
  const auto* const row = std::find_if(std::begin(kKeyMeanings), std::end(kKeyMeanings),
                                       [&](const KeyMeaning& one) { return one.key == event.key; });
  if (row != std::end(kKeyMeanings)) return *row;
  constexpr char32_t kBackspace = 8, kDelete = 127;
  constexpr int kF7 = 7;
  KeyMeaning meaning{event.key};
  if (event.code == kBackspaceCode) meaning.character = kBackspace;
  if (event.code == kDeleteCode) meaning.character = kDelete;
  if (event.code >= kF7Code && event.code <= kF10Code) meaning.action = kF7 + event.code - kF7Code;
  return meaning;
}

std::optional<vrml::KeyStroke> stroke_of(const WindowEvent& event) {
  using Kind = WindowEvent::Kind;
  vrml::KeyStroke stroke;
  if (event.kind == Kind::character) {
    stroke.kind = vrml::KeyStroke::Kind::character;
    stroke.character = static_cast<char32_t>(event.code);
    return stroke;
  }
  if (event.kind != Kind::key_down && event.kind != Kind::key_up) return std::nullopt;
  const KeyMeaning meaning = meaning_of(event);
  stroke.kind = event.kind == Kind::key_down ? vrml::KeyStroke::Kind::press : vrml::KeyStroke::Kind::release;
  stroke.key = event.code != 0 ? event.code : static_cast<int>(event.key);
  stroke.action = meaning.action;
  stroke.character = meaning.character;
  stroke.modifier = meaning.modifier;
  return stroke;
}

bool stays_with_interface(const WindowEvent& event) {
  const int action = meaning_of(event).action;
  constexpr int kLastFunctionKey = 12;
  return event.control || event.alt || event.key == Key::escape || event.key == Key::tab ||
         (action > 0 && action <= kLastFunctionKey);
}

}  // namespace

bool world_takes_key(const View& view, const WindowEvent& event) {
  return event.kind == WindowEvent::Kind::key_down && !stays_with_interface(event) && view.document &&
         view.document->runtime && view.document->runtime->has_started() &&
         view.document->runtime->execution().keys().is_sensed();
}

bool send_to_key_sensors(View& view, const WindowEvent& event, double now) {
  if (!view.document || !view.document->runtime || !view.document->runtime->has_started()) return false;
  vrml::KeyDevice& keys = view.document->runtime->execution().keys();
  if (event.kind == WindowEvent::Kind::focus_lost) {
    keys.release_all();
    return false;
  }
  const auto stroke = stroke_of(event);
  if (!stroke || !keys.is_sensed()) return false;
  const bool taken = world_takes_key(view, event);
  (void)view.document->runtime->step(now);
  keys.send(*stroke);
  return taken;
}

}  // namespace gs::app
