#pragma once

#include "app/media/sound_device.h"
#include "app/media/sound_stage.h"
#include "app/session/documents/documents.h"
#include "app/session/documents/folder_questions.h"
#include "app/session/documents/series.h"
#include "app/session/documents/session_log.h"
#include "app/session/documents/world_reader.h"
#include "app/session/links.h"
#include "app/session/panes.h"
#include "app/session/travel_history.h"
#include "app/view/actions.h"
#include "app/view/panes/split_tree.h"
#include "app/view/picking.h"
#include "app/world/world_loader.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::render {
class MeshWorker;
}

namespace gs::app {

class Session;

struct SessionOptions {
  std::vector<std::string> files;  // opened at start, one per viewport as far as possible
  std::string viewpoint;           // description, DEF name or number of the initial Viewpoint of worlds
  std::optional<bool> headlight;   // overrides the worlds' NavigationInfo
  /// Uses only the time passed to `step`, so that results depend on the input alone. Moves to Viewpoints are instant.
  /// No step is skipped after a slow one. Frames are shown only when they are up to date.
  bool simulated = false;
  bool audible = false;              // sounds are played on the system's device
  bool muted = false;                // until the user turns the sound on
  double speed = 1;                  // factor on the worlds' viewer speed
  ViewStyle style{};                 // initial style of views
  std::optional<Pose> camera{};      // initial camera of the first file
  std::optional<SplitTree> split{};  // split of the window; nullopt derives it from the number of files
};

/// Input of a step of a session.
struct SessionInput {
  struct Event {
    WindowEvent event;
    bool over_interface = false;  // the pointer is over a panel, which handles the event first
  };
  std::vector<Event> events;
  /// Area of all viewports, in framebuffer pixels. Nullopt if the window is minimised.
  std::optional<Viewport> area;
  /// False if no picture is needed yet; render lists then need no update.
  bool look = true;
};

/// Message to the user.
struct Notice {
  std::string text;
  bool is_problem = false;
  std::string_view about =
      {};  // topic: a newer notice with this topic replaces this one, one without text removes it; empty means none
};

/// Result of a step.
struct Frame {
  /// Visible viewport; `view` is null if it is empty. Valid until the next step.
  struct Picture {
    std::size_t pane = 0;
    Viewport place;
    const View* view = nullptr;
  };
  std::vector<Picture> pictures;
  bool changed = false;              // the picture has changed
  bool news = false;                 // files, progress or messages have changed
  bool moving = false;               // motion continues in the next step, whenever that is
  bool loading = false;              // something that the user waits for is still loading
  std::optional<double> next_life;   // time of the worlds' next event, seconds since 1970; nullopt means none
  bool files_chosen = false;         // the user chose other files; older messages are obsolete
  std::vector<std::string> arrived;  // files that became visible or have more content
  struct Failure {
    std::string path, reason;
  };
  std::vector<Failure> failed;  // files that could not be opened
  std::vector<Notice> notices;
  std::vector<std::string> web_pages;  // to open in a web browser
  bool show_log = false;
};

/// Extension that acts in each step of a session, beside the user; see Session::add_extension().
class SessionExtension {
 public:
  virtual ~SessionExtension() = default;
  /// Acts after time has advanced and before the user's input. Returns true if worlds or views changed.
  virtual bool act(Session& session) = 0;
  /// Called at the end of each step.
  virtual void step_is_over() = 0;
};

/// Returns the options for picking in a view, in a viewport of `size` pixels.
[[nodiscard]] PickOptions pick_options(const View& view, const glm::vec2& size);

/// Open worlds, their viewports and time. Reads files, advances worlds, and moves viewers according to the user's
/// input. The window, `--snapshot` and `trace` call `step`, and draw or print its result. The session draws nothing,
/// and reads the clock only to measure durations.
///
/// session.cpp: steps and time; session_files.cpp: loading; session_input.cpp: input; session_panes.cpp: viewports;
/// session_travel.cpp: back and forward; session_pointing.cpp: sensors and Anchors; session_sound.cpp: sound.
///
/// One thread.
class Session {
 public:
  /// Creates a session. `wake` is called on other threads when a step would find news, and must be thread-safe.
  Session(SessionOptions options, LoadOptions load, std::function<void()> wake);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Applies received data and the user's input, and advances time to `now`, in seconds since 1970. Times never go
  /// back.
  Frame step(double now, const SessionInput& input);
  /// Adds an extension that acts in each step, after those that were added before. It must outlive the session or be
  /// removed.
  void add_extension(SessionExtension& guest) { extensions_.push_back(&guest); }
  void remove_extension(SessionExtension& guest) { std::erase(extensions_, &guest); }
  /// Serves a request of a program or client for a world that is shown (VRML97 4.12.10). Returns the reason why no URL
  /// of loadURL may be opened, or nullopt.
  std::optional<std::string> serve(const Document& document, const ScriptRequest& request);
  /// Requests the parts of streams that the last drawn picture lacked.
  void ask_for_streams();
  /// Shows a running world that was opened elsewhere in the active viewport.
  void show(std::shared_ptr<Document> document);

  /// Runs an action. Returns false if it does not belong to the session, or if it has no object to act on.
  bool run(Action action);
  void open_files(const std::vector<std::string>& paths);
  void select_file(std::size_t index);
  /// Opens a file or URL in the active viewport. A non-empty `viewpoint` selects the Viewpoint; else `pose` places the
  /// viewer once everything is loaded. With neither, the view is the initial one or the last one.
  void open_at(const std::string& place, const std::string& viewpoint, const std::optional<Pose>& pose);
  /// Returns true if the history of the active viewport has an entry before (-1) or after (1) the current one.
  [[nodiscard]] bool can_travel(int direction) const;
  /// Sets the factor on the worlds' viewer speed.
  void set_speed(double factor);
  void choose_layout(ViewportLayout layout);
  /// Returns the dividers between the visible viewports.
  [[nodiscard]] std::vector<SplitDivider> dividers() const { return dividers_of(panes_.split(), area_); }
  /// Returns a viewport's share of the bandwidth, 0 to 1; 0 means that it receives nothing.
  [[nodiscard]] double reading_share(std::size_t pane) const;
  /// Returns the limit of a viewport's bandwidth in bits per second; 0 means unlimited.
  [[nodiscard]] std::uint64_t rate_of(std::size_t pane) const;
  /// Returns the bytes received over the network for a viewport.
  [[nodiscard]] std::uint64_t received(std::size_t pane) const;
  /// Sets the memory limit in bytes of worlds that are opened from now on.
  void set_memory(std::size_t bytes) { load_.limits.memory = bytes; }
  /// Changes the split of the window.
  void change_split(SplitTree split);
  /// Moves a divider to a column or row of framebuffer pixels. Viewports keep at least `least` pixels. `ended` is true
  /// when the drag is over.
  void move_divider(const SplitDivider& divider, int place, int least, bool ended);
  /// Serves a request about a viewport.
  void serve(const PaneRequest& request);
  /// Opens a file or URL in a viewport.
  void open_in(std::size_t pane, const std::string& path);
  /// Restores the split of an earlier window, with the files and weights of its viewports.
  void restore_split(const SplitTree& split, const std::map<std::size_t, std::string>& files,
                     const std::map<std::size_t, double>& weights);
  void choose_mode(NavigationMode mode);
  /// Binds a Viewpoint of the active viewport's list in its world.
  void bind_viewpoint(std::size_t index);
  /// Answers question(), or network_question() if there is no other.
  void answer_question(bool allow);
  /// Play or stop the series of files of the active viewport, show one of its files, or set the files per second. Do
  /// nothing if it does not show a series.
  void play_series(bool on);
  void show_of_series(std::size_t file);
  void set_series_rate(double rate);
  /// Returns the series of the active viewport, or null if it does not show one.
  [[nodiscard]] const SeriesList::Series* series() const { return series_.find(panes_.at(panes_.active()).wanted); }
  /// Stops loading the file of a visible viewport.
  void cancel_loading(std::size_t place);

  [[nodiscard]] Panes& panes() { return panes_; }
  [[nodiscard]] const Panes& panes() const { return panes_; }
  [[nodiscard]] bool linked() const { return linked_; }
  /// Returns the sounds of the visible worlds, each at the position of its viewer.
  [[nodiscard]] SoundStage& sounds() { return sounds_; }
  [[nodiscard]] const SoundStage& sounds() const { return sounds_; }
  /// Presses a pointing-device sensor or an Anchor of the active viewport's world, along a line from the viewer to its
  /// geometry. Ignores obstacles. Returns false if the sensor has no collidable geometry, is disabled, or if another
  /// sensor has grabbed the pointer.
  [[nodiscard]] bool press_sensor(const vrml::NodePlace& sensor);
  /// Moves the pointer by pixels, right and down, while press_sensor() holds it.
  void drag_sensor(const glm::dvec2& pixels);
  /// Releases the sensor that press_sensor() has pressed.
  void release_sensor();
  /// Shape of a visible viewport at a framebuffer pixel.
  struct Picked {
    std::size_t pane = 0;
    std::vector<vrml::PathStep> path;  // from the root of its world to the Shape
  };
  /// Returns nullopt if the pixel is outside of all viewports or shows no Shape.
  [[nodiscard]] std::optional<Picked> pick_at(const glm::vec2& pixel);
  /// Flies the active viewport's viewer to a pose that shows all of `bounds`.
  void fly_to(const render::WorldBounds& bounds);
  /// Turns the active view to a side of its object.
  void look_from(ViewSide side);
  /// Returns true if the next click in the active viewport seeks.
  [[nodiscard]] bool seeking() const { return seeking_; }
  /// Returns true if the active viewport's viewer can move back (-1) or forward (1) in its history of poses.
  [[nodiscard]] bool can_undo_move(int direction) const;
  /// Sets the style of files that are shown for the first time, and backdrop and axes of existing views.
  void set_style(const ViewStyle& style);
  /// Moves the active viewport's viewer to a pose with an animation, and applies the pose's projection.
  void go_to(const Pose& pose);
  /// Moves the active viewport's viewer at once.
  void move_viewer_to(const glm::dvec3& place);

  [[nodiscard]] const FolderQuestions::Question* question() const { return questions_.current(); }
  /// Question about the network, with the path of its world.
  struct WorldNetworkQuestion {
    std::string world;
    NetworkQuestion question;
  };
  /// Returns the network question, or nullopt if no world asks.
  [[nodiscard]] std::optional<WorldNetworkQuestion> network_question() const;
  /// Returns the diagnostics of the session's files.
  [[nodiscard]] SessionLog& log() { return log_; }
  [[nodiscard]] const SessionLog& log() const { return log_; }
  /// Files and streams of a world that is open or being read.
  struct Loads {
    std::string path;                    // of the world
    std::shared_ptr<Document> document;  // null while it is being read
    std::shared_ptr<LoadLedger> ledger;
  };
  /// Returns the loads of all worlds, including those that failed last.
  [[nodiscard]] std::vector<Loads> loads() const;
  /// Reads a world again, in the viewports that show it.
  void read_again(const std::string& path) { panes_.reload(path); }
  /// Returns the progress of the readings of a file.
  [[nodiscard]] std::vector<LoadingState> progress_of(const std::string& path) const;
  /// Returns the view of the active viewport, or null if it is empty.
  [[nodiscard]] View* view() { return panes_.at(panes_.active()).view(); }
  /// Returns the viewport that receives pointing-device events for sensors.
  [[nodiscard]] std::optional<std::size_t> pointed_pane() const { return pointed_pane_; }
  /// Object under the pointer in the active viewport: whether a sensor is there or holds the pointer, and the
  /// description of an Anchor (VRML97 6.2).
  struct Pointed {
    bool sensor = false;
    std::string description;
  };
  [[nodiscard]] Pointed pointed() const;
  [[nodiscard]] bool moving() const;

 private:
  /// File that is being read.
  struct Reader {
    DocumentList::Reading reading;
    std::shared_ptr<WorldReader> reader;
    LoadingState state;
  };

  [[nodiscard]] std::vector<Document*> living() const;
  void take_script_news(Document& document);
  void place_viewer(Document& document, const View& leader) const;
  bool advance_worlds(bool look);
  bool run_extensions(bool look);
  void listen(Document& document, const View& leader);
  void change_sound(Action action);
  /// Completes moves to Viewpoints at once in simulated time.
  void end_journey(View& view) const;
  [[nodiscard]] std::optional<double> next_life() const;
  void move_viewer(View& seen, Navigation after, bool loading, float seconds);
  void move_views(float seconds, bool look);
  /// Returns the rectangles of the visible viewports, in the order of `Panes::visible`.
  [[nodiscard]] std::vector<Viewport> places() const;
  [[nodiscard]] Viewport place_of(std::size_t pane) const;
  [[nodiscard]] Viewport place_of(const View& view) const;

  void load_next();
  bool take_news();
  bool take_document(const Reader& from, WorldReader::News& news);
  bool take_meshes();
  bool take_arrivals(Document& document, const std::string& path, WorldReader::News news);
  void prioritize();
  bool feed_streams();
  void note_empty(const Document& document, const std::string& path);
  void show_failed(std::uint64_t reading, const std::string& path, const vrml::Diagnostics& diagnostics);
  void show_loaded();
  [[nodiscard]] bool loading() const;

  void handle(const SessionInput::Event& event);
  void handle_pointer(const SessionInput::Event& event);
  bool run_in(View& view, Action action);
  void point_at(std::size_t pane, const InputTracker::Gesture& gesture);
  void approach(View& view, const Ray& ray, const glm::vec2& size);
  [[nodiscard]] std::vector<std::string> places_of(const std::vector<std::string>& given);
  [[nodiscard]] std::optional<float> distance_under(const View& view, const Ray& ray, const glm::vec2& size);
  void go_to_viewpoint(View& view, std::size_t index);
  void jump_to_viewpoint(View& view, std::size_t index);
  void step_viewpoint(int direction);
  void undo_move(View& view, int direction);
  void tell_of_display(const View& view);
  void fit();
  void reset();
  void change_speed(float factor);
  void activate(std::size_t pane);
  void toggle_link();
  bool run_in_panes(Action action);
  void split_viewport(std::size_t pane, SplitAxis axis);
  void close_viewport(std::size_t pane);
  void forget(std::size_t pane);
  [[nodiscard]] bool reads(std::size_t pane) const;
  void weigh_streams();
  void limit_reading();

  void note_visits();
  void travel(int direction);
  void show_at(const std::string& path, const std::optional<Pose>& pose);
  static void stand_at(View& view, const Pose& pose, bool on_a_way);

  bool point_world(std::size_t pane, bool down);
  bool point_at_sensor(bool down);
  bool point_with(const WindowEvent& event, std::size_t pane);
  void point_again();
  void leave_world();
  void open_links(std::size_t pane);
  void enter_by_link(Pane& pane);
  void follow_link(std::size_t pane, const Link& link);
  void keep_private(const Document& document, const Link& link);

  void tell(std::string text, bool is_problem, std::string_view about = {}) {
    frame_.notices.push_back({std::move(text), is_problem, about});
  }

  SessionOptions options_;
  LoadOptions load_;  // with the folders that the user has allowed
  std::function<void()> wake_;
  Frame frame_;  // result of the next step
  double now_ = 0;
  Viewport area_;
  Panes panes_;
  PointerRouter router_;
  Picker picker_;
  std::shared_ptr<render::MeshWorker> mesh_worker_;  // null in simulated time
  std::optional<std::size_t> pointed_pane_;          // viewport with the pointing device in its world
  glm::vec2 pointer_{0};                             // framebuffer pixels
  bool pointer_moved_ = false;                       // since sensors were updated
  double pressed_at_ = -1e9;                         // time of the last press of a button or key
  bool sensor_has_pointer_ = false;                  // until the button is released
  struct HeldSensor {
    vrml::NodePlace sensor;
    render::SightLine line;
  };
  std::optional<HeldSensor> held_sensor_;       // see press_sensor()
  std::map<std::string, std::string> entries_;  // Viewpoints of links, by file
  std::map<std::string, std::size_t> budgets_;  // vectors that links ask for, by file
  std::map<std::string, Link> places_behind_;   // further URLs of an Anchor, by the file that is being read
  SeriesList series_;
  FolderQuestions questions_;
  std::map<std::string, std::string> private_files_;  // read by Scripts before they opened a file, by path
  SessionLog log_;
  bool linked_ = false;
  bool seeking_ = false;
  std::size_t leader_ = 0;  // viewport that the user moved last
  double next_priorities_ = 0;
  double life_due_ = 0;      // time of the next event in the worlds, if there is one
  bool was_moving_ = false;  // in the previous step
  SoundStage sounds_;
  std::unique_ptr<SoundDevice> device_;  // null while the sound is off; declared after sounds_, which it plays
  std::vector<Reader> readers_;
  std::vector<std::shared_ptr<WorldReader>> retired_;  // no longer needed; they end as soon as they can
  std::vector<Loads> failed_loads_;
  std::vector<SessionExtension*> extensions_;
  bool acted_ = false;                                     // an extension has acted since time advanced in the worlds
  std::array<TravelHistory, kMostViewports> histories_;    // by viewport
  std::map<std::size_t, TravelHistory::Visit> returning_;  // poses of viewers once their files are loaded
};

}  // namespace gs::app
