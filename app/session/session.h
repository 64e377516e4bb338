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
  std::vector<std::string> files;  // opened at start, each in a viewport as far as there are
  std::string viewpoint;           // description, DEF name or number of the Viewpoint where worlds are entered
  std::optional<bool> headlight;   // in place of what the worlds say
  /// Time is what `step` is told and nothing else: who is taken to a Viewpoint is there at once, no step is left out
  /// because the one before took long, and nothing is shown before it is up to date. What follows depends on the input
  /// only.
  bool simulated = false;
  bool audible = false;              // sounds are played on the system's device
  bool muted = false;                // until somebody wants to hear them
  double speed = 1;                  // of the viewer, times what worlds say
  ViewStyle style{};                 // of views of files
  std::optional<Pose> camera{};      // where the first file is first seen from
  std::optional<SplitTree> split{};  // how the viewports share the window; nothing: by how many files there are
};

/// What happens in a step of a session.
struct SessionInput {
  struct Event {
    WindowEvent event;
    bool over_interface = false;  // the pointer is over a panel, which comes first
  };
  std::vector<Event> events;
  /// What the viewports share, in framebuffer pixels. Nothing: the window is closed to an icon, and nobody looks.
  std::optional<Viewport> area;
  /// False: what is to be seen is not asked for yet, and need not be brought up to date.
  bool look = true;
};

/// What is told to the user.
struct Notice {
  std::string text;
  bool is_problem = false;
  std::string_view about =
      {};  // the next one about the same takes its place, of no text: nothing does; empty: none does
};

/// What a step has led to.
struct Frame {
  /// A viewport in sight; null: nothing is shown there. Good until the next step.
  struct Picture {
    std::size_t pane = 0;
    Viewport place;
    const View* view = nullptr;
  };
  std::vector<Picture> pictures;
  bool changed = false;              // something else is to be seen than before
  bool news = false;                 // and something else to be told: files, progress, messages
  bool moving = false;               // it goes on with the next step, whenever that is
  bool loading = false;              // what somebody waits for is still coming
  std::optional<double> next_life;   // when time goes on in a world, in seconds since 1970; nothing: when input comes
  bool files_chosen = false;         // what was told about others is past
  std::vector<std::string> arrived;  // files of which there is something to be seen, or more than before
  struct Failure {
    std::string path, reason;
  };
  std::vector<Failure> failed;  // files that could not be opened
  std::vector<Notice> notices;
  std::vector<std::string> web_pages;  // that are to be opened elsewhere
  bool show_log = false;
};

/// Who does something in a session beside the user, in each step: see Session::add_guest.
class SessionGuest {
 public:
  virtual ~SessionGuest() = default;
  /// Time has gone on to that of the step; what the user does comes next. True: worlds or views are others than before.
  virtual bool act(Session& session) = 0;
  /// The step is over.
  virtual void step_is_over() = 0;
};

/// How a view is picked in, in a viewport of `size` pixels.
[[nodiscard]] PickOptions pick_options(const View& view, const glm::vec2& size);

/// The worlds that are open, the viewports that show them, and time: what is read, what lives, who looks at it from
/// where, and what the user does there. The window, `--snapshot` and `trace` are callers of `step`, and draw or print
/// what it leads to; it draws nothing itself, and reads no clock but to measure how long it took.
///
/// session.cpp: the step, and time; session_files.cpp: what is read; session_input.cpp: what the user does;
/// session_panes.cpp: the viewports; session_travel.cpp: back and forward; session_pointing.cpp: sensors and Anchors;
/// session_sound.cpp: what is heard.
/// One thread.
class Session {
 public:
  /// `wake` is called on other threads when a step would find something new; it must be safe there.
  Session(SessionOptions options, LoadOptions load, std::function<void()> wake);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Takes in what has arrived and what the user has done, and lets time go on to `now`, in seconds since 1970. Times
  /// never go back.
  Frame step(double now, const SessionInput& input);
  /// Who acts in each step from now on, behind those who came before. It must outlive this, or be taken away before.
  void add_guest(SessionGuest& guest) { guests_.push_back(&guest); }
  void remove_guest(SessionGuest& guest) { std::erase(guests_, &guest); }
  /// Serves a request of a program or a client in the name of a world that is shown (VRML97 4.12.10). Returns why no
  /// place of loadURL may be opened, or nullopt.
  std::optional<std::string> serve(const Document& document, const ScriptRequest& request);
  /// After a picture was drawn: asks for what it lacked of streams.
  void ask_for_streams();
  /// Shows a world that was opened elsewhere, and lives, in the active viewport.
  void show(std::shared_ptr<Document> document);

  /// Has an action done. False: it is none of a session's, or there is nothing to do it with.
  bool run(Action action);
  void open_files(const std::vector<std::string>& paths);
  void select_file(std::size_t index);
  /// Opens a file or URL in the active viewport: at the Viewpoint of this name, unless it is empty, then with the
  /// viewer at `pose` once all of it is there. Neither: where it is entered, or was left.
  void open_at(const std::string& place, const std::string& viewpoint, const std::optional<Pose>& pose);
  /// Whether the active viewport has shown something else before (-1), or, gone back from, after (1).
  [[nodiscard]] bool can_travel(int direction) const;
  /// How fast viewers are from now on, times what worlds say.
  void set_speed(double factor);
  void choose_layout(ViewportLayout layout);
  /// Between the viewports in sight, where they are now.
  [[nodiscard]] std::vector<SplitDivider> dividers() const { return dividers_of(panes_.split(), area_); }
  /// What a viewport gets of what is read over the network for all in sight, 0 to 1; 0: nothing is, for it.
  [[nodiscard]] double reading_share(std::size_t pane) const;
  /// Bits a second that may be read for it at most, of all that it waits for; 0: any.
  [[nodiscard]] std::uint64_t rate_of(std::size_t pane) const;
  /// Bytes that have come for it over the network so far.
  [[nodiscard]] std::uint64_t received(std::size_t pane) const;
  /// What a world may take that is opened from now on, bytes.
  void set_memory(std::size_t bytes) { load_.limits.memory = bytes; }
  /// How the window is split from now on.
  void change_split(SplitTree split);
  /// Moves a divider of the split to a column or row of framebuffer pixels; viewports keep `least` pixels. `ended`: it
  /// stays there.
  void move_divider(const SplitDivider& divider, int place, int least, bool ended);
  /// Does with a viewport what somebody wants.
  void serve(const PaneRequest& request);
  /// Opens a file or URL in a viewport.
  void open_in(std::size_t pane, const std::string& path);
  /// As a window was split before, with the files and weights of its viewports.
  void restore_split(const SplitTree& split, const std::map<std::size_t, std::string>& files,
                     const std::map<std::size_t, double>& weights);
  void choose_mode(NavigationMode mode);
  /// One of the active viewport's list, which is bound in the world.
  void bind_viewpoint(std::size_t index);
  /// Answers question(), or network_question() if there is no other.
  void answer_question(bool allow);
  /// Of what the active viewport shows: plays its series of files or stops it, shows one of the files, says how many a
  /// second. Nothing happens where it is no series.
  void play_series(bool on);
  void show_of_series(std::size_t file);
  void set_series_rate(double rate);
  /// Null: it is no series.
  [[nodiscard]] const SeriesList::Series* series() const { return series_.find(panes_.at(panes_.active()).wanted); }
  /// No longer waits for the rest of what a viewport in sight reads.
  void cancel_loading(std::size_t place);

  [[nodiscard]] Panes& panes() { return panes_; }
  [[nodiscard]] const Panes& panes() const { return panes_; }
  [[nodiscard]] bool linked() const { return linked_; }
  /// What is heard of the worlds in sight, each from where its viewer is.
  [[nodiscard]] SoundStage& sounds() { return sounds_; }
  [[nodiscard]] const SoundStage& sounds() const { return sounds_; }
  /// Presses a pointing-device sensor, or an Anchor, of the active viewport's world wherever it is: along a line from
  /// the viewer to its geometry, as if there were nothing else in the world. False: there is nothing to be met of it
  /// now, it is disabled, or another one has the pointer.
  [[nodiscard]] bool press_sensor(const vrml::NodePlace& sensor);
  /// Moves the pointer by so many pixels, to the right and down, while press_sensor has it.
  void drag_sensor(const glm::dvec2& pixels);
  /// Lets go of what press_sensor has pressed.
  void release_sensor();
  /// What a viewport in sight shows at a framebuffer pixel.
  struct Picked {
    std::size_t pane = 0;
    std::vector<vrml::PathStep> path;  // from the root of its world to the Shape
  };
  /// Nothing: there is nothing to be met, or the pixel is no viewport's.
  [[nodiscard]] std::optional<Picked> pick_at(const glm::vec2& pixel);
  /// Flies the active viewport's viewer to where all of this is in sight.
  void fly_to(const render::WorldBounds& bounds);
  /// The active view, from a side of what it shows.
  void look_from(ViewSide side);
  /// Whether the next click in the active viewport goes there.
  [[nodiscard]] bool seeking() const { return seeking_; }
  /// Whether the active viewport's viewer can be taken back to where he rested (-1), and forward again (1).
  [[nodiscard]] bool can_undo_move(int direction) const;
  /// How files are seen from now on that are seen for the first time.
  /// Backdrop and axes of what is seen already, too.
  void set_style(const ViewStyle& style);
  /// Takes the viewer of the active viewport there, on a way; he sees by parallel rays from then on if `pose` does.
  void go_to(const Pose& pose);
  /// Takes the viewer of the active viewport there, at once.
  void move_viewer_to(const glm::dvec3& place);

  [[nodiscard]] const FolderQuestions::Question* question() const { return questions_.current(); }
  /// A question about the network, and the path of the world that it is about.
  struct WorldNetworkQuestion {
    std::string world;
    NetworkQuestion question;
  };
  /// Returns nullopt if no world asks.
  [[nodiscard]] std::optional<WorldNetworkQuestion> network_question() const;
  /// What is said of the files of the session.
  [[nodiscard]] SessionLog& log() { return log_; }
  [[nodiscard]] const SessionLog& log() const { return log_; }
  /// The files and streams of the worlds that are open, or being read.
  struct Loads {
    std::string path;                    // of the world
    std::shared_ptr<Document> document;  // null: it is being read
    std::shared_ptr<LoadLedger> ledger;
  };
  /// Those of worlds that could not be opened last, too.
  [[nodiscard]] std::vector<Loads> loads() const;
  /// Reads a world again, in the viewports that show it.
  void read_again(const std::string& path) { panes_.reload(path); }
  /// How far the readings of a file are.
  [[nodiscard]] std::vector<LoadingState> progress_of(const std::string& path) const;
  /// Of the active viewport; null: nothing is shown there.
  [[nodiscard]] View* view() { return panes_.at(panes_.active()).view(); }
  /// The viewport that the pointing device's events go to, as far as sensors are concerned.
  [[nodiscard]] std::optional<std::size_t> pointed_pane() const { return pointed_pane_; }
  /// What the pointing device is over in the active viewport: whether there is a sensor or it is held by one, and the
  /// description of an Anchor (6.2).
  struct Pointed {
    bool sensor = false;
    std::string description;
  };
  [[nodiscard]] Pointed pointed() const;
  [[nodiscard]] bool moving() const;

 private:
  /// A file that is being read.
  struct Reader {
    DocumentList::Reading reading;
    std::shared_ptr<WorldReader> reader;
    LoadingState state;
  };

  [[nodiscard]] std::vector<Document*> living() const;
  void take_script_news(Document& document);
  void place_viewer(Document& document, const View& leader) const;
  bool let_live(bool look);
  bool let_guest_act(bool look);
  /// In simulated time nobody is on the way to a Viewpoint.
  void listen(Document& document, const View& leader);
  void change_sound(Action action);
  void end_journey(View& view) const;
  [[nodiscard]] std::optional<double> next_life() const;
  void move_viewer(View& seen, Navigation after, bool loading, float seconds);
  void move_views(float seconds, bool look);
  /// Of the viewports in sight, in the order of `Panes::visible`.
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
  LoadOptions load_;  // with what the user has allowed since
  std::function<void()> wake_;
  Frame frame_;  // what the next one tells
  double now_ = 0;
  Viewport area_;
  Panes panes_;
  PointerRouter router_;
  Picker picker_;
  std::shared_ptr<render::MeshWorker> mesh_worker_;  // null in simulated time
  std::optional<std::size_t> pointed_pane_;          // in whose world the pointing device is
  glm::vec2 pointer_{0};                             // framebuffer pixels
  bool pointer_moved_ = false;                       // since sensors heard of it
  double pressed_at_ = -1e9;                         // when somebody has pressed a button or key last
  bool sensor_has_pointer_ = false;                  // until the button is released
  struct HeldSensor {
    vrml::NodePlace sensor;
    render::SightLine line;
  };
  std::optional<HeldSensor> held_sensor_;       // see press_sensor
  std::map<std::string, std::string> entries_;  // Viewpoints that links lead to, by file
  std::map<std::string, std::size_t> budgets_;  // vectors that links ask for, by file
  std::map<std::string, Link> places_behind_;   // what an Anchor names behind a file that is being read, by file
  SeriesList series_;
  FolderQuestions questions_;
  std::map<std::string, std::string> private_files_;  // that Scripts read before they opened a file, by path
  SessionLog log_;
  bool linked_ = false;
  bool seeking_ = false;
  std::size_t leader_ = 0;  // the viewport that the user moved last
  double next_priorities_ = 0;
  double life_due_ = 0;      // when time goes on in the worlds, if it does
  bool was_moving_ = false;  // with the step before
  SoundStage sounds_;
  std::unique_ptr<SoundDevice> device_;  // null: nobody wants to hear anything; behind sounds_, which it plays
  std::vector<Reader> readers_;
  std::vector<std::shared_ptr<WorldReader>> retired_;  // whom nobody waits for; they end as soon as they can
  std::vector<Loads> failed_loads_;
  std::vector<SessionGuest*> guests_;
  bool acted_ = false;                                     // a guest has, since time went on in the worlds
  std::array<TravelHistory, kMostViewports> histories_;    // of the viewports
  std::map<std::size_t, TravelHistory::Visit> returning_;  // where viewers stand once their files are there
};

}  // namespace gs::app
