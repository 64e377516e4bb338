#include "app/viewer/saving/session_record.h"

#include "app/desktop/hand_over.h"

#include <map>
#include <utility>

namespace gs::app {

SessionRecord::SessionRecord(Session& session, SettingsStore& store, std::string not_kept)
    : session_(session), store_(store), not_kept_(std::move(not_kept)), lost_(store.take_lost_sessions()) {
  if (!store_.settings().offers_to_restore) lost_ = {};
}

void SessionRecord::note_recent_files(const std::vector<std::string>& opened) {
  AppState state = store_.state();
  for (const std::string& path : opened)
    if (const std::string place = absolute_place(path);
        path != not_kept_ && (state.recent.empty() || state.recent.front() != place))
      note_recent(state, place);
  store_.set(state);
}

void SessionRecord::note_session() {
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

void SessionRecord::restore(bool wanted) {
  const SessionMemory lost = std::exchange(lost_, {});
  if (!wanted) return;
  session_.opening().open_files(lost.files);
  const auto split = read_split(lost.split);
  const auto* tree = std::get_if<SplitTree>(&split);
  if (!tree) return;
  std::map<std::size_t, std::string> files;
  std::map<std::size_t, double> weights;
  for (const SessionMemory::Viewport& one : lost.viewports) {
    if (!one.file.empty()) files[one.number - 1] = one.file;
    if (one.weight > 0) weights[one.number - 1] = one.weight;
  }
  session_.opening().restore_split(*tree, files, weights);
}

}  // namespace gs::app
