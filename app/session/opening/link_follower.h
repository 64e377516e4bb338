#pragma once

#include "app/session/documents/session_log.h"
#include "app/session/navigation/camera_control.h"
#include "app/session/opening/links.h"
#include "app/session/opening/opening.h"
#include "app/session/opening/travel.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>

namespace gs::app {

/// Links of worlds: Anchors, and the requests of programs and clients (VRML97 4.12.10, 6.2). One thread.
class LinkFollower {
 public:
  LinkFollower(StepContext& step, SessionViewports& viewports, CameraControl& camera, Opening& opening, Travel& travel,
               const LoadOptions& load, SessionLog& log)
      : step_(step),
        viewports_(viewports),
        camera_(camera),
        opening_(opening),
        travel_(travel),
        load_(load),
        log_(log) {}

  /// Follows the Anchor that the pointing device has activated in the world of a viewport.
  void follow_anchors(std::size_t pane);
  /// Serves a request of a program or client for a world that is shown. Returns the reason why no URL of loadURL may be
  /// opened, or nullopt.
  std::optional<std::string> serve(const Document& document, const ScriptRequest& request);
  /// Logs the messages of a world's programs and serves their requests.
  void take_script_news(Document& document);
  /// Moves to the Viewpoint of the link that led here, once the world is running.
  void enter(Pane& pane);
  /// Allows Scripts to open web pages for a short time, because the user has pressed a button or key.
  void note_press() { pressed_at_ = step_.now; }

  /// Ends the link to a file that is now open. Marks its world as private if a Script that opened it was.
  void note_opened(const std::string& path, Document& document);
  /// Returns true if the link to a file has further URLs, to try if the file cannot be opened.
  [[nodiscard]] bool has_fallback(const std::string& path) const;
  /// Tries the next URL of the link to a file that could not be opened (VRML97 6.2).
  void follow_fallback(std::size_t pane, const std::string& path);

 private:
  void follow(std::size_t pane, const Link& link);
  void show_viewpoint(std::size_t pane, const std::string& viewpoint);
  void open(std::size_t pane, const Link& link, std::size_t place);
  void keep_private(const Document& document, const Link& link);

  StepContext& step_;
  SessionViewports& viewports_;
  CameraControl& camera_;
  Opening& opening_;
  Travel& travel_;
  const LoadOptions& load_;
  SessionLog& log_;
  double pressed_at_ = -1e9;                          // time of the last press of a button or key
  std::map<std::string, Link> fallback_urls_;         // further URLs of a link, by the file that is being read
  std::map<std::string, std::string> private_files_;  // read by Scripts before they opened a file, by path
};

}  // namespace gs::app
