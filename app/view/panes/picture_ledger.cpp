#include "app/view/panes/picture_ledger.h"

#include <utility>

namespace gs::app {

bool are_same(const PictureSource& one, const PictureSource& other) {
  const bool same_list = !one.list.owner_before(other.list) && !other.list.owner_before(one.list);
  return same_list && one.shown == other.shown && one.changes == other.changes && one.grown == other.grown &&
         one.camera == other.camera && one.draw == other.draw;
}

bool PictureLedger::is_same(std::size_t viewport, const PictureSource& source) const {
  const auto kept = kept_.find(viewport);
  return kept != kept_.end() && are_same(kept->second.source, source);
}

bool PictureLedger::stands(std::size_t viewport, bool busy) const {
  const auto found = kept_.find(viewport);
  if (found == kept_.end()) return false;
  const Kept& kept = found->second;
  return !kept.refinement.wanted() || (busy && kept.seconds > kQuick);
}

void PictureLedger::note(std::size_t viewport, PictureSource source, const render::FrameStatistics& statistics,
                         double seconds) {
  const bool changed = !is_same(viewport, source);
  Kept& kept = kept_[viewport];
  kept.source = std::move(source);
  kept.seconds = seconds;
  kept.refinement.note(statistics.pending, statistics.vectors, changed);
}

void PictureLedger::note_given_up(std::size_t viewport, const render::FrameStatistics& statistics) {
  Kept& kept = kept_[viewport];
  kept.source = {};
  kept.refinement.note(statistics.pending, statistics.vectors, true);
}

bool PictureLedger::wants_more(std::size_t viewport) const {
  const auto kept = kept_.find(viewport);
  return kept != kept_.end() && kept->second.refinement.wanted();
}

}  // namespace gs::app
