#include "app/loading/listing/folder_choice.h"

#include "app/formats/content_types.h"
#include "app/formats/datasets/zarr/zarr_place.h"
#include "base/text.h"

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <utility>

namespace gs::app {
namespace {

using FolderResult = std::variant<FolderChoice, std::string>;

bool is_hidden(std::string_view name) { return name.starts_with('.') || name.find("/.") != std::string_view::npos; }

FolderResult step_of_numbered(std::span<const std::string> names, const NumberedName& series,
                              const std::optional<qnv::ShownStep>& wanted) {
  std::vector<std::pair<std::uint64_t, std::string>> found;
  for (const std::string& name : names)
    if (const auto number = number_in(series, name)) found.emplace_back(*number, name);
  if (found.empty()) return "no file of the series " + series.before + "N" + series.after + " is in the list";
  std::ranges::sort(found);
  // Keeps only the newest steps of a very long series.
  if (found.size() > kMaxTimeSteps)
    found.erase(found.begin(), found.end() - static_cast<std::ptrdiff_t>(kMaxTimeSteps));
  FolderChoice choice;
  for (const auto& [number, name] : found) choice.steps.times.push_back(static_cast<double>(number));
  choice.steps.shown = wanted ? qnv::step_number(*wanted, choice.steps.times) : 0;
  choice.files = {std::move(found[choice.steps.shown].second)};
  return choice;
}

}  // namespace

std::optional<NumberedName> series_of_url(std::string_view url) {
  if (url.find_first_of("?#") != std::string_view::npos || url.find("://") == std::string_view::npos)
    return std::nullopt;
  return numbered_name(url.substr(url.rfind('/') + 1));
}

FolderResult choose_in_folder(std::span<const std::string> names, const std::optional<NumberedName>& series,
                              const std::optional<qnv::ShownStep>& wanted) {
  if (series) return step_of_numbered(names, *series, wanted);
  FolderChoice choice;
  for (const std::string_view entry : zarr_entry_files())
    if (std::ranges::find(names, entry) != names.end()) choice.files.emplace_back(entry);
  if (!choice.files.empty()) return choice;
  std::vector<const std::string*> slices, others;
  for (const std::string& name : names) {
    if (is_hidden(name)) continue;
    const ContentType* const type = content_type_by_name(name);
    const std::string_view file = std::string_view(name).substr(name.rfind('/') + 1);
    if (type && type->mime == "application/dicom")
      slices.push_back(&name);
    else if (type)
      others.push_back(&name);
    else if (file.find('.') == std::string_view::npos)
      slices.push_back(&name);  // many scanners write names without extension
  }
  if (!slices.empty() && others.size() < slices.size()) {
    // Prefers a name with the extension of DICOM, which is certainly a slice.
    const auto certain =
        std::ranges::find_if(slices, [](const std::string* name) { return content_type_by_name(*name); });
    choice.files = {certain == slices.end() ? *slices.front() : **certain};
    choice.is_scan = true;
    return choice;
  }
  if (others.size() == 1) {
    choice.files = {*others.front()};
    return choice;
  }
  if (others.empty())
    return "a folder with " + std::to_string(names.size()) + " files; none has a known format";
  return "a folder with " + std::to_string(names.size()) + " files; open one of them, such as " +
         shortened(*others.front(), 100);
}

}  // namespace gs::app
