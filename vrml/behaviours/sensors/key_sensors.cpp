#include "vrml/events/execution.h"

#include <string>

// KeySensor and StringSensor (X3D clause 21).
namespace gs::vrml {
namespace {

struct KeyEvents {
  enum : int {
    enabled = kKeySensorEnabled,
    is_active,
    action_press,
    action_release,
    key_press,
    key_release,
    shift,
    control,
    alt
  };
};
struct TextEvents {
  enum : int { enabled = kKeySensorEnabled, is_active, entered, final_text, deletion_allowed };
};

constexpr char32_t kBackspaceKey = 8, kEnterKey = '\n', kEscapeKey = 27, kSpaceKey = ' ', kDeleteKey = 127;

std::string utf8_of(char32_t c) {
  std::string text;
  const auto add = [&](char32_t byte) { text += static_cast<char>(byte); };
  if (c < 0x80) {
    add(c);
  } else if (c < 0x800) {
    add(0xC0 | c >> 6);
    add(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    add(0xE0 | c >> 12);
    add(0x80 | (c >> 6 & 0x3F));
    add(0x80 | (c & 0x3F));
  } else {
    add(0xF0 | (c >> 18 & 7));
    add(0x80 | (c >> 12 & 0x3F));
    add(0x80 | (c >> 6 & 0x3F));
    add(0x80 | (c & 0x3F));
  }
  return text;
}

void set_keys_active(Execution& execution, EventNode node, bool active) {
  if (active != execution.get<SFBool>(node, KeyEvents::is_active))
    execution.send(node, KeyEvents::is_active, SFBool{active});
}

void sense_key(Execution& execution, EventNode node, const KeyStroke& stroke) {
  const bool down = stroke.kind != KeyStroke::Kind::release;
  set_keys_active(execution, node, down || execution.keys().is_any_held());
  if (stroke.modifier == ModifierKey::shift) execution.send(node, KeyEvents::shift, SFBool{down});
  if (stroke.modifier == ModifierKey::control) execution.send(node, KeyEvents::control, SFBool{down});
  if (stroke.modifier == ModifierKey::alt) execution.send(node, KeyEvents::alt, SFBool{down});
  if (stroke.action != 0)
    execution.send(node, down ? KeyEvents::action_press : KeyEvents::action_release, SFInt32{stroke.action});
  if (stroke.character != 0)
    execution.send(node, down ? KeyEvents::key_press : KeyEvents::key_release, SFString(utf8_of(stroke.character)));
}

void enter_text(Execution& execution, EventNode node, const KeyStroke& stroke) {
  constexpr std::size_t kMaxText = 4096;
  const char32_t c = stroke.character;
  if (stroke.kind == KeyStroke::Kind::release || c == 0) return;
  const bool active = execution.get<SFBool>(node, TextEvents::is_active);
  std::string text = active ? execution.get<SFString>(node, TextEvents::entered).str() : std::string();
  if (c == kEnterKey || c == kEscapeKey) {
    if (!active) return;
    if (c == kEnterKey) execution.send(node, TextEvents::final_text, SFString(text));
    execution.send(node, TextEvents::is_active, SFBool{false});
  } else if (c == kBackspaceKey) {
    if (!active || text.empty() || !execution.get<SFBool>(node, TextEvents::deletion_allowed)) return;
    while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0) == 0x80) text.pop_back();
    if (!text.empty()) text.pop_back();
    execution.send(node, TextEvents::entered, SFString(text));
  } else if (c >= kSpaceKey && c != kDeleteKey) {
    const std::string added = utf8_of(c);
    if (text.size() + added.size() > kMaxText) return;
    set_keys_active(execution, node, true);
    execution.send(node, TextEvents::entered, SFString(text + added));
  }
}

bool key_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  if (event == kKeySensorEnabled && !std::get<SFBool>(value)) set_keys_active(execution, node, false);
  return true;
}

void begin_keys(Execution& execution, EventNode node) { execution.keys().add(node); }
void end_keys(Execution& execution, EventNode node) { execution.keys().remove(node); }

}  // namespace

const Behaviour kKeySensorBehaviour = {
    .events = {"enabled", "isActive", "actionKeyPress", "actionKeyRelease", "keyPress", "keyRelease", "shiftKey",
               "controlKey", "altKey"},
    .initialize = begin_keys,
    .on_event = key_event,
    .on_key = sense_key,
    .on_remove = end_keys,
};
const Behaviour kStringSensorBehaviour = {
    .events = {"enabled", "isActive", "enteredText", "finalText", "deletionAllowed"},
    .initialize = begin_keys,
    .on_event = key_event,
    .on_key = enter_text,
    .on_remove = end_keys,
};

}  // namespace gs::vrml
