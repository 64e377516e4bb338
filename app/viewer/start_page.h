#pragma once

#include "app/session/viewports/view.h"
#include "app/settings/thumbnails.h"
#include "app/view/viewports.h"
#include "render/draw/renderer.h"

#include <memory>
#include <string>
#include <vector>

namespace gs::app {

/// Pictures of the start page, which empty viewports show: thumbnails of recent files. The interface draws the texts.
/// Main thread.
class StartPage {
 public:
  /// `state_folder` is UserFolders::state; the thumbnails are in a folder below. If it is empty, none are stored.
  explicit StartPage(const std::string& state_folder);

  /// Sets the recent files, newest first, and the number of pixels per unit of the design. Removes the thumbnails of
  /// other files if the list has changed.
  void set_recent(const std::vector<std::string>& places, float scale);
  /// Reports whether to store a thumbnail of a displayed view: once for each document that is a recent file, when its
  /// picture rests or some seconds after it appeared. `now` is in seconds of any clock.
  [[nodiscard]] bool wants(const View& view, bool rests, double now);
  /// Stores the thumbnail of the view's document as PNG bytes.
  void keep(const View& view, const std::vector<std::byte>& png);
  /// Draws the thumbnails in the viewport `place`, with `draw` for the rest of the picture.
  [[nodiscard]] render::FrameStatistics draw(render::Renderer& renderer, const Viewport& place,
                                             const render::DrawOptions& draw);

 private:
  Thumbnails thumbnails_;
  float scale_ = 1;
  std::vector<std::string> recent_;
  std::weak_ptr<const Document> shown_;  // document that was displayed last
  double shown_since_ = 0;
  bool kept_ = false;  // the thumbnail of `shown_` is stored
  std::shared_ptr<const vrml::Mesh> square_;
};

}  // namespace gs::app
