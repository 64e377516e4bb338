#pragma once

#include "app/loading/world_loader.h"
#include "app/session/documents/session_log.h"
#include "app/session/input/input_handler.h"
#include "app/session/input/pointing.h"
#include "app/session/live/live_control.h"
#include "app/session/navigation/camera_control.h"
#include "app/session/navigation/session_sound.h"
#include "app/session/navigation/viewer_motion.h"
#include "app/session/opening/data_choices.h"
#include "app/session/opening/document_readers.h"
#include "app/session/opening/first_views.h"
#include "app/session/opening/follower.h"
#include "app/session/opening/link_follower.h"
#include "app/session/opening/opening.h"
#include "app/session/opening/series_playback.h"
#include "app/session/opening/session_questions.h"
#include "app/session/opening/stream_transfers.h"
#include "app/session/opening/travel.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"
#include "app/view/picking.h"
#include "base/noncopyable.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

class Session;

struct SessionOptions {
  std::vector<std::string> files;  // opened at the start, each in its own viewport if possible
  std::string viewpoint;           // initial Viewpoint of worlds: its description, DEF name or number
  std::optional<bool> headlight;   // overrides the NavigationInfo of worlds
  /// Simulated time: results depend only on the input and on the times given to step(). Moves to Viewpoints are
  /// instant. A slow step does not delay later ones. Pictures wait until all data for them are ready.
  bool simulated = false;
  bool audible = false;              // play sounds on the system's device
  bool muted = false;                // silent until the user turns the sound on
  double speed = 1;                  // factor on the viewer speed that worlds set
  ViewStyle style{};                 // initial style of views
  std::optional<Pose> camera{};      // initial camera, only for the first file
  std::optional<SplitTree> split{};  // arrangement of the viewports; nullopt derives it from the number of files
  std::shared_ptr<EarlyReader> early{};  // reader of the first file, if it has started
};

/// Extension that acts in each step of a session, in addition to the user; see Session::add_extension().
class SessionExtension {
 public:
  virtual ~SessionExtension() = default;
  /// Acts in a step, after time has advanced and before the user's input is handled. Returns true if worlds or views
  /// changed.
  virtual bool act(Session& session) = 0;
  /// Called at the end of each step, before the pictures are drawn.
  virtual void step_is_over() {}
};

/// Documents, viewports and time of one program run. The window, `--snapshot` and `trace` call step() and draw or print
/// its result. The session itself draws nothing. It reads the clock only to measure durations. step() calls the parts
/// of the session in a fixed order. One thread.
class Session : NonCopyable {
 public:
  /// Creates a session. Other threads call `wake` when the next step has something to do; it must be thread-safe.
  Session(const SessionOptions& options, LoadOptions load, const std::function<void()>& wake);

  /// Runs one step: applies received data and the user's input, and advances time to `now`, in seconds since 1970.
  /// `now` must never decrease.
  Frame step(double now, const SessionInput& input);
  /// Adds an extension. It acts in each step, after the extensions that were added earlier. It must be removed before
  /// it is destroyed, unless it outlives the session.
  void add_extension(SessionExtension& extension) { extensions_.push_back(&extension); }
  void remove_extension(SessionExtension& extension) { std::erase(extensions_, &extension); }

  // Parts of the session.
  [[nodiscard]] SessionViewports& viewports() { return viewports_; }
  [[nodiscard]] Panes& panes() { return viewports_.panes(); }
  [[nodiscard]] const Panes& panes() const { return viewports_.panes(); }
  /// Returns the view of the active viewport; null if the viewport is empty.
  [[nodiscard]] View* view() { return viewports_.view(); }
  [[nodiscard]] Opening& opening() { return opening_; }
  [[nodiscard]] DocumentReaders& readers() { return readers_; }
  [[nodiscard]] StreamTransfers& streams() { return streams_; }
  [[nodiscard]] LinkFollower& links() { return links_; }
  [[nodiscard]] Travel& travel() { return travel_; }
  [[nodiscard]] CameraControl& camera() { return camera_; }
  [[nodiscard]] ViewerMotion& motion() { return motion_; }
  [[nodiscard]] Pointing& pointing() { return pointing_; }
  [[nodiscard]] SessionSound& sound() { return sound_; }
  [[nodiscard]] SeriesPlayback& series() { return series_; }
  [[nodiscard]] DataChoices& data() { return data_; }
  [[nodiscard]] Follower& follower() { return follower_; }
  [[nodiscard]] LiveControl& live() { return live_; }
  [[nodiscard]] SessionQuestions& questions() { return questions_; }
  [[nodiscard]] InputHandler& input() { return input_; }
  /// Returns the log of diagnostics of all files.
  [[nodiscard]] SessionLog& log() { return log_; }

 private:
  [[nodiscard]] std::vector<Document*> running();
  bool advance_worlds(bool look);
  bool advance_world(Document& document, bool look);
  bool run_extensions(bool look);
  void place_viewer(Document& document, const View& leader) const;
  void handle_input(const SessionInput& input, float seconds);
  [[nodiscard]] std::optional<double> next_event();

  LoadOptions load_;  // options for files, including the folders that the user has allowed
  StepContext step_;
  Picker picker_;
  SessionLog log_;
  SessionViewports viewports_;
  SessionSound sound_;
  SeriesPlayback series_;
  SessionQuestions questions_;
  CameraControl camera_;
  ViewerMotion motion_;
  Opening opening_;
  Travel travel_;
  LinkFollower links_;
  Pointing pointing_;
  FirstViews first_views_;
  DataChoices data_;
  Follower follower_;
  LiveControl live_;
  DocumentReaders readers_;
  StreamTransfers streams_;
  InputHandler input_;
  std::vector<SessionExtension*> extensions_;
  double life_due_ = 0;      // earliest time of the next step of worlds, in seconds since 1970
  bool acted_ = false;       // an extension acted after the last step of worlds
  bool was_moving_ = false;  // a viewer moved in the previous step
};

}  // namespace gs::app
