#include "app/loading/content/series_step.h"

#include "app/formats/content_types.h"
#include "app/formats/datasets/vtk/vtk_index.h"
#include "base/text.h"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {
namespace {

// Reports whether the reader of VTK reads a series with a file of this name as a whole.
bool is_for_vtk(const std::string& name) {
  const std::string lower = lower_case(name);
  const std::size_t point = lower.rfind('.');
  if (point == std::string::npos) return true;
  const std::string extension = lower.substr(point);
  return extension.starts_with(".vt") || extension.starts_with(".pvt") || extension == ".pvd" ||
         content_type_by_name(name) == nullptr;
}

}  // namespace

bool is_file_series(std::span<const std::byte> first) {
  const std::string_view text = text_of(first);
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  return start != std::string_view::npos && text[start] == '{' && vtk_class_of(first) == VtkFileClass::steps;
}

std::optional<SeriesStep> step_of_series(std::span<const std::byte> bytes,
                                         const std::optional<qnv::ShownStep>& wanted) {
  if (!is_file_series(bytes)) return std::nullopt;
  auto read = read_vtk_index(bytes);
  auto* const index = std::get_if<VtkIndex>(&read);
  if (!index || index->members.empty() || is_for_vtk(index->members.front().file)) return std::nullopt;
  std::vector<VtkMember>& members = index->members;
  std::ranges::stable_sort(members, {}, &VtkMember::time);
  // Keeps only the newest steps of a very long series.
  if (members.size() > kMaxTimeSteps)
    members.erase(members.begin(), members.end() - static_cast<std::ptrdiff_t>(kMaxTimeSteps));
  SeriesStep step;
  for (const VtkMember& member : members) step.steps.times.push_back(member.time);
  step.steps.shown = wanted ? qnv::step_number(*wanted, step.steps.times) : 0;
  step.file = std::move(members[step.steps.shown].file);
  return step;
}

}  // namespace gs::app
