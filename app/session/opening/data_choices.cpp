#include "app/session/opening/data_choices.h"

#include "app/formats/common/dataset_list.h"

#include <utility>

namespace gs::app {

VoxelComponent DataChoices::of(const std::string& path) const {
  const auto found = choices_.find(path);
  return found == choices_.end() ? load_.component : found->second;
}

void DataChoices::choose(const VoxelComponent& choice) {
  if (!active_path().empty()) choose_for(active_path(), choice);
}

void DataChoices::choose_for(const std::string& path, const VoxelComponent& choice) {
  VoxelComponent wanted = choice;
  wanted.found.reset();
  DocumentList& documents = viewports_.panes().documents();
  const auto document = documents.document(path);
  // After a choice that could not be read, the same choice is tried again.
  if (wanted == of(path) && (documents.awaited(path) || (document && document->data.dataset == wanted.dataset))) return;
  choices_[path] = std::move(wanted);
  documents.cancel(path);
  documents.reload(path);
  step_.frame.news = true;
}

std::string DataChoices::add_view(const VoxelComponent& choice) {
  const DocumentList& documents = viewports_.panes().documents();
  std::size_t number = 2;
  while (documents.find(further_view(active_path(), number))) ++number;
  std::string path = further_view(active_path(), number);
  choices_[path] = choice;
  choices_[path].found.reset();
  return path;
}

void DataChoices::show_beside(const std::string& path) {
  Panes& panes = viewports_.panes();
  viewports_.announce_change();
  if (!panes.split_pane(panes.active(), SplitAxis::columns))
    return step_.notify("All " + std::to_string(kMaxViewports) + " viewports are in use. Close one first.", true);
  const std::size_t added = panes.active();
  panes.show_in(added, path);
  viewports_.set_linked(true);
  step_.frame.changed = step_.frame.news = true;
}

void DataChoices::show_beside(const VoxelComponent& choice) {
  if (!active_path().empty()) show_beside(add_view(choice));
}

void DataChoices::show_over(const VoxelComponent& choice) {
  Panes& panes = viewports_.panes();
  if (active_path().empty()) return;
  panes.add_over(panes.active(), add_view(choice));
  step_.frame.news = true;
}

void DataChoices::show_file_beside(std::size_t file) {
  const auto& entries = viewports_.panes().documents().entries();
  if (file < entries.size()) show_beside(std::string(entries[file].path));
}

void DataChoices::show_file_over(std::size_t file) {
  Panes& panes = viewports_.panes();
  const auto& entries = panes.documents().entries();
  if (file >= entries.size()) return;
  panes.add_over(panes.active(), std::string(entries[file].path));
  step_.frame.changed = step_.frame.news = true;
}

void DataChoices::remove_over(std::size_t index) {
  viewports_.panes().remove_over(viewports_.panes().active(), index);
  step_.frame.changed = step_.frame.news = true;
}

void DataChoices::note_opened(const std::string& path, Document& document) {
  const auto before = viewports_.panes().documents().document(path);
  DatasetList* const list = document.data.found.get();
  const DatasetList* const known = before ? before->data.found.get() : nullptr;
  if (!list || !known || known == list || list->shown != known->shown) return;
  if (document.data.step && list->times.empty()) list->times = known->times;
  if (document.data.chosen && list->components == 1) list->components = known->components;
}

}  // namespace gs::app
