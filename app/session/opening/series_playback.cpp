#include "app/session/opening/series_playback.h"

namespace gs::app {

void SeriesPlayback::play(bool on) {
  if (list_.play(name(), on, step_.now)) panes_.reload(name());
  step_.frame.news = true;
}

void SeriesPlayback::show(std::size_t file) {
  if (list_.show(name(), file, step_.now)) panes_.reload(name());
  step_.frame.news = true;
}

}  // namespace gs::app
