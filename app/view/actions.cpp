#include "app/view/actions.h"

#include <algorithm>
#include <array>

namespace gs::app {
namespace {

constexpr Key operator""_key(char letter) { return letter_key(letter); }

constexpr std::string_view kSides = "Standard views", kUps = "Up axis", kDisplays = "Faces", kSounds = "Sound",
                           kTexts = "Text size";

constexpr ActionRow kActions[] = {
    {Action::next_viewpoint, Key::page_down, false, false, true, "", "Next viewpoint", Menu::navigate},
    {Action::previous_viewpoint, Key::page_up, false, false, true, "", "Previous viewpoint", Menu::navigate},
    {Action::reset, Key::home, false, false, true, "Reset", "Return to the viewpoint", Menu::navigate},
    {Action::fit, 'F'_key, false, false, true, "Fit", "Frame the scene", Menu::navigate},
    {Action::headlight, 'H'_key, false, false, true, "Headlight", "Headlight", Menu::view},
    {Action::examine, '1'_key, false, false, true, "Examine", "Examine: turn about a point", Menu::navigate},
    {Action::fly, '2'_key, false, false, true, "Fly", "Fly: move freely", Menu::navigate},
    {Action::walk, '3'_key, false, false, true, "Walk", "Walk: stay on the ground", Menu::navigate},
    {Action::pan, '4'_key, false, false, true, "Pan", "Pan: slide the view", Menu::navigate},
    {Action::look_at, '5'_key, false, false, true, "Look at", "Look at: go to a clicked point", Menu::navigate},
    {Action::ghost, 'G'_key, false, false, true, "Ghost", "Ghost: no collision or gravity", Menu::navigate},
    {Action::faster, Key::plus, false, false, true, "", "Move faster", Menu::navigate},
    {Action::slower, Key::minus, false, false, true, "", "Move slower", Menu::navigate},
    {Action::open_file, 'O'_key, true, false, false, "Open", "Open a file", Menu::file},
    {Action::save_as, 'S'_key, true, false, true, "Save as", "Save as: write the world to a file", Menu::file},
    {Action::next_file, Key::tab, true, false, false, "", "Next file", Menu::file},
    {Action::previous_file, Key::tab, true, true, false, "", "Previous file", Menu::file},
    {Action::reload, Key::f5, false, false, false, "", "Reload", Menu::file},
    {Action::next_layout, Key::f6, false, false, false, "", "One, two or four viewports", Menu::window},
    {Action::viewport_1, '1'_key, true, false, false, "", "Focus viewport 1", Menu::window},
    {Action::viewport_2, '2'_key, true, false, false, "", "Focus viewport 2", Menu::window},
    {Action::viewport_3, '3'_key, true, false, false, "", "Focus viewport 3", Menu::window},
    {Action::viewport_4, '4'_key, true, false, false, "", "Focus viewport 4", Menu::window},
    {Action::split_right, Key::right, true, true, true, "", "Split right", Menu::window},
    {Action::split_below, Key::down, true, true, true, "", "Split below", Menu::window},
    {Action::maximise, 'M'_key, true, false, false, "", "Maximise viewport", Menu::window},
    {Action::swap_viewports, 'X'_key, true, true, false, "", "Swap with next viewport", Menu::window},
    {Action::even_out, '0'_key, true, true, false, "", "Equalise viewport sizes", Menu::window},
    {Action::next_pane, Key::f6, true, false, false, "", "Focus next viewport", Menu::window},
    {Action::previous_pane, Key::f6, true, true, false, "", "Focus previous viewport", Menu::window},
    {Action::close_viewport, 'W'_key, true, false, false, "", "Close viewport", Menu::window},
    {Action::link, 'L'_key, false, false, true, "Link", "Link viewports", Menu::window},
    {Action::help, Key::f1, false, false, false, "?", "Keys and mouse", Menu::help},
    {Action::statistics, Key::f2, false, false, false, "", "Statistics", Menu::view},
    {Action::log, Key::f3, false, false, false, "Log", "Log: errors and warnings", Menu::view},
    {Action::transfer, Key::f4, false, false, false, "Transfer", "Transfer function and clipping", Menu::view},
    {Action::data, 'D'_key, true, true, false, "Data", "Data: datasets, steps, colours", Menu::view},
    {Action::splats, 'G'_key, true, true, false, "Splats", "Splats: crop, clean, transform", Menu::view},
    {Action::scene_tree, 'T'_key, true, true, false, "Tree", "Scene tree: nodes of the world", Menu::view},
    {Action::inspector, 'I'_key, true, true, false, "Inspector", "Inspector: fields of a node", Menu::view},
    {Action::routes, 'R'_key, true, true, false, "Routes", "Routes and their events", Menu::view},
    {Action::script_console, 'J'_key, true, true, false, "Console", "Script console", Menu::view},
    {Action::streams, 'E'_key, true, true, false, "Streams", "Streams: loading progress", Menu::view},
    {Action::pick, 'N'_key, true, true, false, "Pick", "Pick a node (Alt+click)", Menu::view},
    {Action::measure, 'V'_key, false, false, true, "Measure", "Measure: values and slices", Menu::view},
    {Action::ruler, 'R'_key, false, false, true, "Ruler", "Ruler: lengths, angles, areas", Menu::view},
    {Action::take_picture, Key::f12, false, false, false, "", "Save picture", Menu::file},
    {Action::copy_picture, 'C'_key, true, false, true, "", "Copy picture", Menu::file},
    {Action::pictures, Key::unknown, false, false, false, "Pictures", "Pictures and movies", Menu::file},
    {Action::tour_view, 'T'_key, false, false, true, "", "Add view to tour", Menu::file},
    {Action::mute, 'M'_key, false, false, true, "Sound", "Sound on", Menu::view, false, kSounds},
    {Action::louder, '.'_key, false, false, true, "", "Louder", Menu::view, false, kSounds},
    {Action::softer, ','_key, false, false, true, "", "Softer", Menu::view, false, kSounds},
    {Action::full_screen, Key::f11, false, false, false, "", "Full screen", Menu::window},
    {Action::palette, 'P'_key, true, true, false, "", "Command palette", Menu::view},
    {Action::address, 'L'_key, true, false, false, "", "Open a path or URL", Menu::file},
    {Action::back, Key::left, false, false, false, "", "Previous world", Menu::navigate, true},
    {Action::forward, Key::right, false, false, false, "", "Next world", Menu::navigate, true},
    {Action::bookmark, 'D'_key, true, false, false, "", "Bookmark this view", Menu::file},
    {Action::preferences, ','_key, true, false, false, "", "Preferences", Menu::file},
    {Action::larger_text, Key::plus, true, false, false, "", "Larger text", Menu::view, false, kTexts},
    {Action::smaller_text, Key::minus, true, false, false, "", "Smaller text", Menu::view, false, kTexts},
    {Action::normal_text, '0'_key, true, false, false, "", "Default text size", Menu::view, false, kTexts},
    {Action::theme, Key::unknown, false, false, false, "", "Switch dark and light theme", Menu::view},
    {Action::side_front, '1'_key, false, true, true, "", "View from the front", Menu::navigate, false, kSides},
    {Action::side_back, '2'_key, false, true, true, "", "View from the back", Menu::navigate, false, kSides},
    {Action::side_left, '3'_key, false, true, true, "", "View from the left", Menu::navigate, false, kSides},
    {Action::side_right, '4'_key, false, true, true, "", "View from the right", Menu::navigate, false, kSides},
    {Action::side_top, '5'_key, false, true, true, "", "View from above", Menu::navigate, false, kSides},
    {Action::side_bottom, '6'_key, false, true, true, "", "View from below", Menu::navigate, false, kSides},
    {Action::straighten, 'U'_key, false, false, true, "", "Straighten: make up vertical", Menu::navigate},
    {Action::seek, 'K'_key, false, false, true, "", "Seek: move halfway to a point", Menu::navigate},
    {Action::undo, 'Z'_key, true, false, true, "", "Undo movement or edit", Menu::navigate},
    {Action::redo, 'Z'_key, true, true, true, "", "Redo movement or edit", Menu::navigate, false, {}, 'Y'_key},
    {Action::orthographic, 'O'_key, false, false, true, "", "Parallel projection", Menu::view},
    {Action::display_surface, Key::unknown, false, false, true, "", "Faces: filled", Menu::view, false, kDisplays},
    {Action::display_edges, Key::unknown, false, false, true, "", "Faces: filled, with edges", Menu::view, false,
     kDisplays},
    {Action::display_wireframe, Key::unknown, false, false, true, "", "Faces: wireframe", Menu::view, false, kDisplays},
    {Action::display_points, Key::unknown, false, false, true, "", "Faces: points", Menu::view, false, kDisplays},
    {Action::next_display, 'X'_key, false, false, true, "", "Faces: next style", Menu::view, false, kDisplays},
    {Action::grid, 'N'_key, false, false, true, "", "Grid on the ground", Menu::view},
    {Action::backdrop, Key::unknown, false, false, false, "", "Gradient background", Menu::view},
    {Action::axes, Key::unknown, false, false, false, "", "Coordinate axes", Menu::view},
    {Action::copy_camera, 'C'_key, true, true, true, "", "Copy camera", Menu::navigate},
    {Action::copy_viewpoint, Key::unknown, false, false, true, "", "Copy camera as Viewpoint node", Menu::navigate},
    {Action::paste_camera, 'V'_key, true, false, true, "", "Paste camera", Menu::navigate},
    {Action::up_auto, Key::unknown, false, false, true, "", "Up: automatic", Menu::view, false, kUps},
    {Action::up_x, Key::unknown, false, false, true, "", "Up: +X", Menu::view, false, kUps},
    {Action::up_minus_x, Key::unknown, false, false, true, "", "Up: -X", Menu::view, false, kUps},
    {Action::up_y, Key::unknown, false, false, true, "", "Up: +Y", Menu::view, false, kUps},
    {Action::up_minus_y, Key::unknown, false, false, true, "", "Up: -Y", Menu::view, false, kUps},
    {Action::up_z, Key::unknown, false, false, true, "", "Up: +Z", Menu::view, false, kUps},
    {Action::up_minus_z, Key::unknown, false, false, true, "", "Up: -Z", Menu::view, false, kUps},
    {Action::close, Key::escape, false, false, false, "", "Close dialog or stop loading", Menu::window},
    {Action::quit, 'Q'_key, true, false, false, "", "Quit", Menu::file},
};

struct KeyName {
  Key key;
  std::string_view name;
};
constexpr KeyName kKeyNames[] = {
    {Key::page_down, "Page Down"},
    {Key::page_up, "Page Up"},
    {Key::home, "Home"},
    {Key::plus, "+"},
    {Key::minus, "-"},
    {Key::tab, "Tab"},
    {Key::f1, "F1"},
    {Key::f2, "F2"},
    {Key::f3, "F3"},
    {Key::f4, "F4"},
    {Key::f5, "F5"},
    {Key::f6, "F6"},
    {Key::f11, "F11"},
    {Key::f12, "F12"},
    {Key::escape, "Esc"},
    {Key::end, "End"},
    {Key::left, "Left"},
    {Key::right, "Right"},
    {Key::up, "Up"},
    {Key::down, "Down"},
    {Key::space, "Space"},
    {Key::enter, "Enter"},
    {Key::shift, "Shift"},
    {Key::control, "Ctrl"},
    {Key::alt, "Alt"},
};

}  // namespace

std::span<const ActionRow> actions() { return kActions; }

std::string_view title_of(Menu menu) {
  static constexpr std::string_view kTitles[kMenus] = {"File", "View", "Navigate", "Window", "Help"};
  return kTitles[static_cast<std::size_t>(menu)];
}

const ActionRow& row_of(Action action) {
  return *std::find_if(std::begin(kActions), std::end(kActions),
                       [&](const ActionRow& row) { return row.action == action; });
}

const ActionRow* action_of(const WindowEvent& event) {
  const ActionRow* without_shift = nullptr;
  for (const ActionRow& row : kActions) {
    if (row.control_key != Key::unknown && row.control_key == event.key && event.control && !event.alt) return &row;
    if (row.key == Key::unknown || row.key != event.key || row.control != event.control || row.alt != event.alt)
      continue;
    if (row.shift == event.shift) return &row;
    // Accept the key with Shift, because many keyboards need Shift to type +. Shift+Tab is a different action.
    if (!row.shift && row.key != Key::tab) without_shift = &row;
  }
  return without_shift;
}

std::optional<Key> find_key(std::string_view name) {
  const auto upper = [](char letter) {
    return letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 32) : letter;
  };
  if (name.size() == 1 && name[0] > ' ' && name[0] <= '~') return letter_key(upper(name[0]));
  for (const KeyName& each : kKeyNames)
    if (std::equal(name.begin(), name.end(), each.name.begin(), each.name.end(),
                   [&](char one, char other) { return upper(one) == upper(other); }))
      return each.key;
  return std::nullopt;
}

std::string keys_of(const ActionRow& row) {
  if (row.key == Key::unknown) return {};
  std::string text = row.control ? "Ctrl+" : "";
  if (row.alt) text += "Alt+";
  if (row.shift) text += "Shift+";
  for (const KeyName& name : kKeyNames)
    if (name.key == row.key) return text.append(name.name);
  return text += static_cast<char>(row.key);
}

std::string all_keys_of(const ActionRow& row) {
  std::string text = keys_of(row);
  if (row.control_key == Key::unknown) return text;
  const ActionRow other{row.action, row.control_key, true, false, row.of_world, row.label, row.help};
  return text.append(text.empty() ? "" : ", ").append(keys_of(other));
}

std::string tooltip_of(Action action) {
  const ActionRow& row = row_of(action);
  const std::string keys = keys_of(row);
  return std::string(row.help) + (keys.empty() ? "" : " (" + keys + ")");
}

}  // namespace gs::app
