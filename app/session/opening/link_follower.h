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

/// Follower of links: of Anchors, and of requests by Scripts and --control clients (VRML97 4.12.10, 6.2). One thread.
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

  /// Follows the Anchor that the pointing device has activated in a viewport's world.
  void follow_anchors(std::size_t pane);
  /// Serves a request of a Script or client for a visible world. If it is a loadURL of which no URL may be opened,
  /// returns the reason; otherwise returns nullopt.
  std::optional<std::string> serve(const Document& document, const ScriptRequest& request);
  /// Logs the messages of a world's Scripts and serves their requests.
  void take_script_news(Document& document);
  /// Moves the viewer to the Viewpoint of the link that led to this file. Does nothing until the world is running.
  void enter(Pane& pane);
  /// Records that the user pressed a button or key. For a short time afterwards, Scripts may open web pages.
  void note_press() { pressed_at_ = step_.now; }

  /// Completes the link to a file that is now open. Marks its world as private if a private world opened it.
  void note_opened(const std::string& path, Document& document);
  /// Returns true if the link to a file has further URLs, for the case that the file cannot be opened.
  [[nodiscard]] bool has_fallback(const std::string& path) const;
  /// Tries the next URL of the link that led to a file, because the file could not be opened (VRML97 6.2).
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
  double pressed_at_ = -1e9;  // session time of the last press of a button or key, in seconds
  std::map<std::string, Link> fallback_urls_;  // remaining URLs of the link to a file, by the path of that file
  std::map<std::string, std::string> private_files_;  // private file read by the opening Script, by path of the world
};

}  // namespace gs::app
