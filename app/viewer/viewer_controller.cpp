#include "app/viewer/viewer_controller.h"

#include "app/base/console.h"
#include "app/view/camera_text.h"
#include "app/viewer/hand_over.h"
#include "base/text.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

namespace gs::app {
namespace {

constexpr double kTextStep = 0.1;
constexpr double kSameCamera = 1e-4;  // max difference between numbers of cameras that count as equal

// Returns the title of the window, made of the title and the file name of the world.
std::string title_of(const std::string& title, const std::string& file) {
  constexpr std::size_t kMax = 100;  // max bytes of the world's title
  if (title.empty() || title == file) return file;
  return shortened(title, kMax) + " (" + file + ")";
}

std::vector<double> camera_numbers(const Pose& pose) {
  const auto number = [](float value) { return static_cast<double>(value); };
  std::vector<double> numbers{pose.position.x,
                              pose.position.y,
                              pose.position.z,
                              number(pose.orientation.x),
                              number(pose.orientation.y),
                              number(pose.orientation.z),
                              number(pose.orientation.w)};
  if (pose.height > 0) numbers.push_back(pose.height);
  return numbers;
}

bool are_alike(const std::vector<double>& one, const std::vector<double>& other) {
  return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [](double a, double b) { return std::abs(a - b) <= kSameCamera * (1 + std::abs(a)); });
}

// Returns the pose for the numbers of a camera. The field of view is that of `before`.
std::optional<Pose> pose_of_camera(const std::vector<double>& camera, const Pose& before) {
  if (camera.size() != Bookmark::kCameraNumbers && camera.size() != Bookmark::kParallelNumbers) return std::nullopt;
  for (const double number : camera)
    if (!std::isfinite(number) || std::abs(number) > kFarthest) return std::nullopt;
  Pose pose = before;
  pose.position = {camera[0], camera[1], camera[2]};
  const glm::dquat orientation(camera[6], camera[3], camera[4], camera[5]);
  const double length = glm::length(orientation);
  if (!(length > 1e-6)) return std::nullopt;
  pose.orientation = glm::quat(orientation / length);
  pose.height = camera.size() == Bookmark::kParallelNumbers ? camera.back() : 0;
  return valid_pose(pose, before);
}

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
      not_kept_(options.not_kept),
      up_given_(options.up_given),
      memory_given_(load.limits.memory != Limits{}.memory),
      ui_(std::move(backend), options.scale, store_.settings()),
      session_(with_settings(options.session, store_.settings(), options.up_given), std::move(load), wake),
      dialog_(wake, options.dialogs),
      saver_(
          {session_, ui_, dialog_, store_}, not_kept_, [this] { window_.close(); }, wake) {
  if (!memory_given_) session_.opening().set_memory(memory_of(store_.settings().memory));
  session_.add_extension(inspection_);
  const AppState& state = store_.state();
  ui_.arrange(state.panels, state.areas);
  lost_ = store_.take_lost_sessions();
  if (!store_.settings().offers_to_restore) lost_ = {};
}

ViewerController::~ViewerController() {
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
      if (row && !(row->of_world && typed) && run(row->action)) continue;
      if (typed && !(row && !row->of_world)) continue;
      if (inspection_.takes_arrows() && is_arrow(event.key)) continue;
    }
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
      if (ui_.close_over() || window_.run_tool(action)) return true;
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
      toggle_bookmark();
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
  if (pane.shown.empty() || pane.shown == not_kept_ || !std::filesystem::is_regular_file(pane.shown, error)) return ".";
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
  const auto edit = seen ? seen->document->edits.time_of(direction) : std::nullopt;
  if (!edit) return false;
  const auto move = seen->history.time_of(direction);
  if (move && (direction < 0 ? *move > *edit : *move < *edit)) return false;
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
  if (actions.open_bookmark) open_bookmark(*actions.open_bookmark);
  if (actions.remove_bookmark && *actions.remove_bookmark < store_.bookmarks().size()) {
    std::vector<Bookmark> kept = store_.bookmarks();
    kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(*actions.remove_bookmark));
    store_.set(kept);
  }
  if (actions.restore) {
    if (*actions.restore) restore();
    lost_ = {};
  }
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
  window_.apply_tools(actions.tools);
  View* seen = session_.view();
  if (!seen) return;
  if (actions.viewpoint) {
    const std::vector<std::size_t> listed = listed_viewpoints(seen->list->viewpoints);
    if (*actions.viewpoint < listed.size()) session_.camera().bind_viewpoint(listed[*actions.viewpoint]);
  }
  if (actions.mode) session_.camera().choose_mode(*actions.mode);
  if (actions.look) seen->look = *actions.look;
}

// Bookmarks ---------------------------------------------------------------------------------------

// Returns a bookmark of the active viewport's Viewpoint. If the viewer has moved away from the Viewpoint, the bookmark
// also has the pose.
std::optional<Bookmark> ViewerController::bookmark_of_view() {
  const Pane& pane = session_.panes().at(session_.panes().active());
  const View* seen = pane.view();
  if (!seen || pane.shown.empty()) return std::nullopt;
  Bookmark bookmark;
  bookmark.place = absolute_place(pane.shown);
  const auto& viewpoints = seen->list->viewpoints;
  if (seen->viewpoint && *seen->viewpoint < viewpoints.size())
    bookmark.viewpoint = viewpoint_label(viewpoints[*seen->viewpoint], *seen->viewpoint);
  if (!at_home(*seen)) bookmark.camera = camera_numbers(seen->navigation.pose);
  const std::string file = file_label(pane.shown);
  bookmark.title = title_of(seen->document->world.title, file);
  if (!bookmark.viewpoint.empty()) bookmark.title += ": " + shortened(bookmark.viewpoint, 80);
  return bookmark;
}

std::optional<std::size_t> ViewerController::find_bookmark() {
  const auto here = bookmark_of_view();
  if (!here) return std::nullopt;
  const std::vector<Bookmark>& all = store_.bookmarks();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].place == here->place && all[i].viewpoint == here->viewpoint && are_alike(all[i].camera, here->camera))
      return i;
  return std::nullopt;
}

void ViewerController::toggle_bookmark() {
  std::vector<Bookmark> kept = store_.bookmarks();
  if (const auto present = find_bookmark()) {
    kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(*present));
    ui_.show_notice("Bookmark removed", false);
  } else if (auto bookmark = bookmark_of_view()) {
    ui_.show_notice("Bookmarked: " + bookmark->title, false);
    kept.push_back(std::move(*bookmark));
  }
  store_.set(kept);
}

void ViewerController::open_bookmark(std::size_t index) {
  if (index >= store_.bookmarks().size()) return;
  const Bookmark bookmark = store_.bookmarks()[index];
  const View* seen = session_.view();
  // If the file is already open by another spelling of its path, use that spelling.
  std::string place = bookmark.place;
  for (const DocumentList::Entry& entry : session_.panes().documents().entries())
    if (absolute_place(entry.path) == place) place = entry.path;
  session_.travel().open_at(place, bookmark.viewpoint,
                            pose_of_camera(bookmark.camera, seen ? seen->navigation.pose : Pose{}));
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
  }
  for (const Notice& notice : frame.notices) ui_.show_notice(notice.text, notice.is_problem, notice.about);
  for (const std::string& page : frame.web_pages) {
    const bool opened = open_in_browser(page);
    ui_.show_notice((opened ? "Opened in the web browser: " : "Cannot start a web browser for ") + page, false);
  }
  if (frame.show_log) ui_.show_panel(Action::log);
  if (!frame.arrived.empty()) remember(frame.arrived);
  if (frame.news || frame.files_chosen) note_session();
  return any || !frame.notices.empty() || !frame.web_pages.empty() || frame.show_log;
}

void ViewerController::remember(const std::vector<std::string>& arrived) {
  AppState state = store_.state();
  for (const std::string& path : arrived)
    if (const std::string place = absolute_place(path);
        path != not_kept_ && (state.recent.empty() || state.recent.front() != place))
      note_recent(state, place);
  store_.set(state);
}

void ViewerController::note_session() {
  SessionMemory session;
  for (const DocumentList::Entry& entry : session_.panes().documents().entries())
    if (entry.path != not_kept_) session.files.push_back(absolute_place(entry.path));
  const Panes& panes = session_.panes();
  session.split = split_text(panes.split());
  for (const std::size_t i : panes_of(panes.split())) {
    const Pane& pane = panes.at(i);
    const bool kept = !pane.wanted.empty() && pane.wanted != not_kept_;
    session.viewports.push_back({i + 1, kept ? absolute_place(pane.wanted) : std::string(), pane.weight});
  }
  store_.note_session(session);
}

void ViewerController::restore() {
  session_.opening().open_files(lost_.files);
  const auto split = read_split(lost_.split);
  const auto* tree = std::get_if<SplitTree>(&split);
  if (!tree) return;
  std::map<std::size_t, std::string> files;
  std::map<std::size_t, double> weights;
  for (const SessionMemory::Viewport& one : lost_.viewports) {
    if (!one.file.empty()) files[one.number - 1] = one.file;
    if (one.weight > 0) weights[one.number - 1] = one.weight;
  }
  session_.opening().restore_split(*tree, files, weights);
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
  const char* const edited = seen->document->edits.unsaved() ? ", edited" : "";
  return title_of(world.title, file_label(world.path)) + edited + " - GhostSpace";
}

}  // namespace gs::app
