#include "app/viewer/viewer_controller.h"

#include "app/base/console.h"
#include "app/desktop/hand_over.h"
#include "app/session/navigation/key_input.h"
#include "app/view/camera_text.h"
#include "app/viewer/viewer_data.h"
#include "app/viewer/viewer_splats.h"
#include "base/text.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

namespace gs::app {
namespace {

constexpr double kTextStep = 0.1;

SessionOptions with_settings(SessionOptions options, const UserSettings& settings, bool up_given) {
  if (!up_given) options.style.up = settings.up;
  options.style.backdrop = settings.backdrop;
  options.style.axes = settings.axes;
  options.muted = options.muted || !settings.sound;
  options.speed = settings.speed;
  return options;
}

std::size_t memory_of(double gibibytes) { return static_cast<std::size_t>(gibibytes * (1 << 30)); }

// Dismisses the message of a visible viewport that could not show a file. Returns false if there is none.
bool dismiss_failure(Session& session) {
  for (const std::size_t pane : session.panes().visible()) {
    if (!session.panes().at(pane).failure) continue;
    session.input().serve(PaneRequest{PaneRequest::Kind::dismiss, pane});
    return true;
  }
  return false;
}

bool is_arrow(Key key) { return key == Key::left || key == Key::right || key == Key::up || key == Key::down; }

}  // namespace

ViewerController::ViewerController(ViewerControllerOptions options, LoadOptions load,
                                   std::unique_ptr<InterfaceBackend> backend, WindowOperations& window,
                                   const std::function<void()>& wake)
    : store_(options.folders),
      window_(window),
      up_given_(options.up_given),
      memory_given_(load.limits.memory != Limits{}.memory),
      ui_(std::move(backend), options.scale, store_.settings()),
      session_(with_settings(options.session, store_.settings(), options.up_given), std::move(load), wake),
      splat_editing_(wake),
      bookmarks_(session_, store_),
      record_(session_, store_, options.not_kept),
      dialog_(wake, options.dialogs),
      saver_(
          {session_, ui_, dialog_, store_}, record_.not_kept(), [this] { window_.close(); }, wake) {
  if (!memory_given_) session_.opening().set_memory(memory_of(store_.settings().memory));
  session_.add_extension(inspection_);
  session_.add_extension(splat_editing_);
  const AppState& state = store_.state();
  ui_.arrange(state.panels, state.areas);
}

ViewerController::~ViewerController() {
  session_.remove_extension(splat_editing_);
  session_.remove_extension(inspection_);
  AppState state = store_.state();
  state.panels = ui_.panels();
  state.areas = ui_.areas();
  store_.set(state);
}

void ViewerController::note_window(int width, int height, const std::optional<std::array<int, 2>>& place) {
  AppState state = store_.state();
  state.width = width;
  state.height = height;
  state.place = place;
  store_.set(state);
}

std::vector<SessionInput::Event> ViewerController::take(const std::vector<WindowEvent>& events) {
  std::vector<SessionInput::Event> result;
  for (const WindowEvent& event : events) {
    if (event.kind == WindowEvent::Kind::key_down) {
      const ActionRow* row = action_of(event);
      const bool typed = ui_.wants_keys();
      const View* const seen = session_.view();
      const bool taken = !typed && seen && world_takes_key(*seen, event);
      if (row && !taken && !(row->of_world && typed) && run(row->action)) continue;
      if (typed && !(row && !row->of_world)) continue;
      if (inspection_.takes_arrows() && is_arrow(event.key)) continue;
    }
    if (event.kind == WindowEvent::Kind::character && ui_.wants_keys()) continue;
    if (picks(event)) continue;
    const SessionInput::Event one{event, ui_.wants_pointer()};
    if (!window_.take(one)) result.push_back(one);
  }
  return result;
}

// Selects the node under the pointer, if the event is Alt+click or the click after Action::pick. Returns true if it
// handled the event.
bool ViewerController::picks(const WindowEvent& event) {
  if (event.kind != WindowEvent::Kind::button_down || event.button != MouseButton::left || ui_.wants_pointer() ||
      !(event.alt || inspection_.picking()))
    return false;
  if (inspection_.pick(session_, event.pointer))
    ui_.show_panel(Action::scene_tree);
  else
    ui_.show_notice("No node under the pointer", false);
  return true;
}

// Runs an action that concerns the interface, the settings or the window. Returns false if the session must run it.
bool ViewerController::run(Action action) {
  UserSettings settings = store_.settings();
  switch (action) {
    case Action::open_file:
      if (!settings.system_dialog || !dialog_.show(folder_of_file())) ui_.show_open_dialog();
      return true;
    case Action::full_screen:
      window_.toggle_full_screen();
      return true;
    case Action::quit:
      if (may_close()) window_.close();
      return true;
    case Action::save_as:
      saver_.ask_for_file();
      return true;
    case Action::undo:
    case Action::redo:
      return undo(action == Action::undo ? -1 : 1);
    case Action::reload:
    case Action::close_viewport:
      return !saver_.permits(action);  // the session runs the action
    case Action::pick:
      inspection_.set_picking(!inspection_.picking());
      if (inspection_.picking()) ui_.show_notice("Click an object to select its node", false);
      return true;
    case Action::close:
      if (session_.camera().seeking()) return false;  // the session must end seeking
      if (inspection_.picking()) {
        inspection_.set_picking(false);
        return true;
      }
      if (ui_.close_over()) {
        // The address field keeps the focus after a file that could not be opened.
        if (ui_.wants_keys()) (void)dismiss_failure(session_);
        return true;
      }
      if (window_.run_tool(action)) return true;
      if (session_.panes().loading(session_.panes().active())) return false;  // the session must cancel loading
      return dismiss_failure(session_) || ui_.close_beside();
    case Action::larger_text:
      settings.text_size += kTextStep;
      break;
    case Action::smaller_text:
      settings.text_size -= kTextStep;
      break;
    case Action::normal_text:
      settings.text_size = 1;
      break;
    case Action::theme:
      settings.theme = settings.theme == Theme::dark ? Theme::light : Theme::dark;
      break;
    case Action::backdrop:
      settings.backdrop = !settings.backdrop;
      break;
    case Action::axes:
      settings.axes = !settings.axes;
      break;
    case Action::bookmark:
      if (const std::string notice = bookmarks_.toggle(); !notice.empty()) ui_.show_notice(notice, false);
      return true;
    case Action::copy_camera:
    case Action::copy_viewpoint:
    case Action::paste_camera:
      exchange_camera(action);
      return true;
    default:
      return window_.run_tool(action) || ui_.run(action);
  }
  const SettingRow& row = *find_setting("text-size");
  settings.text_size = std::clamp(std::round(settings.text_size * 10) / 10, row.least, row.most);
  change(settings);
  return true;
}

// Returns the folder of the file in the active viewport. Dialogs show it first.
std::string ViewerController::folder_of_file() const {
  const Pane& pane = session_.panes().at(session_.panes().active());
  std::error_code error;
  if (pane.shown.empty() || pane.shown == record_.not_kept() || !std::filesystem::is_regular_file(pane.shown, error))
    return ".";
  const std::filesystem::path folder = std::filesystem::path(pane.shown).parent_path();
  return folder.empty() ? "." : folder.string();
}

// Copies the camera to the clipboard, or applies the camera in the clipboard.
void ViewerController::exchange_camera(Action action) {
  const View* seen = session_.view();
  if (!seen) return;
  if (action == Action::paste_camera) {
    const auto camera = read_camera(ui_.clipboard());
    if (const auto* problem = std::get_if<std::string>(&camera))
      return ui_.show_notice("The clipboard has no camera: " + *problem, true);
    return session_.camera().go_to(std::get<Pose>(camera));
  }
  const Pose& pose = seen->navigation.pose;
  ui_.set_clipboard(action == Action::copy_camera ? camera_text(pose) : viewpoint_text(pose));
  ui_.show_notice("Copied: " + ui_.clipboard(), false);
}

// Undoes or redoes an edit if that was the last action. Returns false if a movement of the viewer was, which the
// session handles.
bool ViewerController::undo(int direction) {
  const View* const seen = session_.view();
  if (!seen) return false;
  SplatEdits& splats = seen->document->splats;
  const auto edit = seen->document->edits.time_of(direction), splat_edit = splats.time_of(direction),
             move = seen->history.time_of(direction);
  // Returns true if `one` is the next change to undo or redo.
  const auto precedes = [direction](const std::optional<double>& one, const std::optional<double>& other) {
    return one && (!other || (direction < 0 ? *one >= *other : *one <= *other));
  };
  if (precedes(splat_edit, edit) && precedes(splat_edit, move)) {
    splats.go(direction);
    return true;
  }
  if (!precedes(edit, move)) return false;
  inspection_.step_edit(direction);
  return true;
}

void ViewerController::change(const UserSettings& settings) {
  if (settings.speed != store_.settings().speed) session_.camera().set_speed(settings.speed);
  if (!memory_given_) session_.opening().set_memory(memory_of(settings.memory));
  ViewStyle style = session_.viewports().loading().style();
  if (!up_given_) style.up = settings.up;
  style.backdrop = settings.backdrop;
  style.axes = settings.axes;
  session_.viewports().set_style(style);
  store_.set(settings);
}

void ViewerController::apply(const UiActions& actions) {
  if (actions.settings) change(*actions.settings);
  if (actions.open) {
    opening_ = given_place(*actions.open).target;
    session_.opening().open_files({*actions.open});
  }
  if (actions.open_bookmark) bookmarks_.open(*actions.open_bookmark);
  if (actions.remove_bookmark) bookmarks_.remove(*actions.remove_bookmark);
  if (actions.restore) record_.restore(*actions.restore);
  if (actions.file) session_.opening().select_file(*actions.file);
  if (actions.layout) session_.viewports().choose_layout(*actions.layout);
  if (actions.divider)
    session_.viewports().move_divider(actions.divider->divider, actions.divider->place, actions.divider->least,
                                      actions.divider->ended);
  if (actions.save) saver_.save_to(*actions.save, false);
  if (actions.answer) saver_.answer(*actions.answer);
  if (actions.pane && saver_.permits(*actions.pane)) session_.input().serve(*actions.pane);
  if (actions.run && !run(*actions.run)) (void)session_.input().run(*actions.run);
  if (actions.allow_question) session_.questions().answer(*actions.allow_question);
  if (actions.cancel_loading) session_.readers().cancel(*actions.cancel_loading);
  if (actions.tools.play) session_.series().play(*actions.tools.play);
  if (actions.tools.file) session_.series().show(*actions.tools.file);
  if (actions.tools.rate) session_.series().set_rate(*actions.tools.rate);
  apply_data(actions.data, session_);
  apply_splats(actions.splats, session_);
  window_.apply_tools(actions.tools);
  View* seen = session_.view();
  if (!seen) return;
  if (actions.viewpoint) {
    const std::vector<std::size_t> listed = listed_viewpoints(seen->list->viewpoints, seen->navigation.pose.position);
    if (*actions.viewpoint < listed.size()) session_.camera().bind_viewpoint(listed[*actions.viewpoint]);
  }
  if (actions.mode) session_.camera().choose_mode(*actions.mode);
  if (actions.look) seen->look = *actions.look;
}

// Messages ----------------------------------------------------------------------------------------

bool ViewerController::tell(const Frame& frame) {
  bool any = saver_.take_results();
  for (const std::string& line : store_.take_problems()) {
    complain("ghostspace: %s", line.c_str());
    store_.log(line);
    ui_.show_notice(line, true);
    any = true;
  }
  if (frame.files_chosen) ui_.clear_notices();
  const auto chosen = [this](const std::string& path) { return path == opening_; };
  if (std::any_of(frame.arrived.begin(), frame.arrived.end(), chosen)) ui_.open_ended({});
  for (const Frame::Failure& failure : frame.failed)
    if (chosen(failure.path)) ui_.open_ended(failure.reason);
  for (const std::string& line : session_.log().take_untold()) {
    complain("%s", line.c_str());
    store_.log(line);
    any = true;  // the number of log entries, and the card of a world that stopped responding
  }
  for (const Notice& notice : frame.notices) ui_.show_notice(notice.text, notice.is_problem, notice.about);
  for (const std::string& page : frame.web_pages) {
    const bool opened = open_in_browser(page);
    ui_.show_notice((opened ? "Opened in the web browser: " : "Cannot start a web browser for ") + page, false);
  }
  if (frame.show_log) ui_.show_panel(Action::log);
  std::vector<std::string> files = frame.arrived;
  std::erase_if(files, [](const std::string& path) { return view_number(path) > 1; });
  if (!files.empty()) record_.note_recent_files(files);
  if (frame.news || frame.files_chosen) record_.note_session();
  return any || !frame.notices.empty() || !frame.web_pages.empty() || frame.show_log;
}

bool ViewerController::take_chosen_files() {
  const auto answer = dialog_.take();
  if (!answer) return false;
  if (answer->saves) {
    if (answer->failed) saver_.ask_in_window();
    if (!answer->files.empty()) saver_.save_to(answer->files.front(), true);
    return true;
  }
  if (answer->failed) ui_.show_open_dialog();
  if (!answer->files.empty()) session_.opening().open_files(answer->files);
  return true;
}

std::string ViewerController::title() {
  const View* seen = session_.view();
  if (!seen) return "GhostSpace";
  const LoadedWorld& world = seen->document->world;
  const char* const edited = seen->document->unsaved() ? ", edited" : "";
  return title_of_world(world.title, file_label(world.path)) + edited + " - GhostSpace";
}

}  // namespace gs::app
