#include "app/session/opening/opening.h"

#include "app/session/opening/links.h"

#include <algorithm>
#include <utility>

namespace gs::app {

void Opening::start(const std::vector<std::string>& paths, const std::optional<SplitTree>& split) {
  viewports_.panes().start(targets_of(paths), split);
}

void Opening::open_files(const std::vector<std::string>& paths) {
  step_.frame.files_chosen = true;
  // Allow worlds to read the files that the user opens, as for files on the command line.
  const std::vector<std::string> targets = targets_of(paths);
  load_.allowed.insert(load_.allowed.end(), targets.begin(), targets.end());
  viewports_.panes().open(targets);
}

void Opening::select_file(std::size_t index) {
  step_.frame.files_chosen = true;
  viewports_.panes().select(index);
}

void Opening::open_in(std::size_t pane, const std::string& path) {
  step_.frame.files_chosen = true;
  if (const auto target = allowed_target(path)) viewports_.panes().show_in(pane, *target);
}

void Opening::open_again(std::size_t pane) {
  Panes& panes = viewports_.panes();
  if (pane >= kMaxViewports || !has_pane(panes.split(), pane)) return;
  step_.frame.changed = step_.frame.news = true;
  if (!panes.at(pane).failure) return panes.reload(pane);
  open_in(pane, std::string(panes.at(pane).failure->path));
}

void Opening::restore_split(const SplitTree& split, const std::map<std::size_t, std::string>& files,
                            const std::map<std::size_t, double>& weights) {
  viewports_.change_split(split);
  for (const std::size_t pane : panes_of(split)) {
    if (const auto weight = weights.find(pane); weight != weights.end())
      viewports_.panes().at(pane).weight = std::clamp(weight->second, Pane::kMinWeight, Pane::kMaxWeight);
    if (const auto file = files.find(pane); file != files.end()) open_in(pane, file->second);
  }
}

std::optional<std::string> Opening::allowed_target(const std::string& place) {
  const std::vector<std::string> targets = targets_of({place});
  if (targets.empty()) return std::nullopt;
  load_.allowed.push_back(targets.front());
  return targets.front();
}

void Opening::show(const std::string& path) {
  step_.frame.files_chosen = true;
  Panes& panes = viewports_.panes();
  const auto& entries = panes.documents().entries();
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (entries[i].path == path) return panes.select(i);
  panes.open(std::vector<std::string>{path});
}

// Returns the paths and URLs without the names of Viewpoints, which are stored for the time when the worlds are loaded.
std::vector<std::string> Opening::targets_of(const std::vector<std::string>& given) {
  std::vector<std::string> targets;
  for (const std::string& one : given) {
    const GivenPlace place = given_place(one);
    if (!place.problem.empty()) {
      Diagnostics said;
      said.add({Severity::error, one, {}, place.problem});
      log_.note(one, said);
      step_.frame.failed.push_back({one, place.problem});
      step_.frame.show_log = true;
      step_.notify("Cannot open " + file_label(one) + ": " + place.problem, true);
      continue;
    }
    if (!place.viewpoint.empty()) entries_[place.target] = place.viewpoint;
    if (place.budget > 0) budgets_[place.target] = place.budget;
    targets.push_back(place.target);
  }
  return targets;
}

const std::string* Opening::entry_of(const std::string& path) const {
  const auto found = entries_.find(path);
  return found == entries_.end() ? nullptr : &found->second;
}

std::size_t Opening::budget_of(const std::string& path) const {
  const auto found = budgets_.find(path);
  return found == budgets_.end() ? 0 : found->second;
}

}  // namespace gs::app
