#include "app/formats/common/dataset_list.h"

#include "app/formats/common/transfer.h"
#include "base/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

namespace gs::app {
namespace {

std::string last_name(std::string_view path) { return std::string(path.substr(path.rfind('/') + 1)); }

/// Returns the number of changes that turn one text into another (Levenshtein).
std::size_t distance_of(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t corner = row[0];
    row[0] = i + 1;
    for (std::size_t k = 0; k < b.size(); ++k) {
      const std::size_t above = row[k + 1];
      row[k + 1] = std::min({above + 1, row[k] + 1, corner + (a[i] == b[k] ? 0 : 1)});
      corner = above;
    }
  }
  return row.back();
}

std::string nearest_names(std::span<const DatasetEntry> entries, std::string_view choice) {
  constexpr std::size_t kMostNames = 5, kMostCompared = 10'000, kLongest = 200;
  std::vector<std::pair<std::size_t, std::string_view>> near;
  const std::string wanted = lower_case(last_name(choice.substr(0, kLongest)));
  for (const DatasetEntry& entry : entries.first(std::min(entries.size(), kMostCompared))) {
    if (entry.form == DatasetForm::nothing) continue;
    const std::string name = lower_case(last_name(entry.path));
    const bool part = !wanted.empty() && name.find(wanted) != std::string::npos;
    near.emplace_back(part ? 0 : distance_of(std::string_view(name).substr(0, kLongest), wanted), entry.path);
  }
  std::ranges::stable_sort(near, {}, &std::pair<std::size_t, std::string_view>::first);
  std::string text;
  for (std::size_t i = 0; i < std::min(near.size(), kMostNames); ++i)
    text += (i == 0 ? "" : ", ") + std::string(near[i].second);
  return text;
}

}  // namespace

bool is_bookkeeping(std::string_view name) {
  const std::string lower = lower_case(name);
  static constexpr std::string_view kParts[] = {
      "vtkoriginal",     "vtkghost",       "globalnodeid",    "globalelementid",   "globalid",       "globalpointid",
      "globalcellid",    "pedigree",       "objectid",        "processid",         "vtkvalidpoint",  "originalids",
      "originalpointid", "originalcellid", "originalcell_id", "vtkcompositeindex", "vtkblockcolors", "vtkinsidednes"};
  return std::ranges::any_of(kParts, [&](std::string_view part) { return lower.find(part) != std::string::npos; });
}

std::variant<std::size_t, std::string> choose_dataset(std::span<const DatasetEntry> entries, std::string_view choice,
                                                      bool by_view) {
  if (choice.empty()) {
    const auto rank = [by_view](const DatasetEntry& one) {
      return by_view && one.view_rank > 0 ? one.view_rank : one.rank;
    };
    const DatasetEntry* best = nullptr;
    for (const DatasetEntry& entry : entries)
      if (entry.form != DatasetForm::nothing && (!best || rank(entry) > rank(*best))) best = &entry;
    if (best) return static_cast<std::size_t>(best - entries.data());
    for (const DatasetEntry& entry : entries)
      if (!entry.note.empty()) return entry.path + ": " + entry.note;
    return "none of its " + std::to_string(entries.size()) +
           " datasets can be shown; expected numbers along 2 to 5 axes (info lists the datasets)";
  }
  const auto shown = [&](std::size_t i) -> std::variant<std::size_t, std::string> {
    if (entries[i].form != DatasetForm::nothing) return i;
    return entries[i].path + " cannot be shown: " +
           (entries[i].note.empty() ? "it is " + entries[i].type + ", " + shape_text(entries[i].shape) +
                                          "; expected numbers along 2 to 5 axes"
                                    : entries[i].note);
  };
  std::string path(choice);
  if (!path.starts_with('/')) path.insert(0, "/");
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (entries[i].path == path) return shown(i);
  std::optional<std::size_t> ending;
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (entries[i].path.ends_with(path)) {
      if (ending)
        return "several datasets end with '" + std::string(choice) + "': " + entries[*ending].path + ", " +
               entries[i].path;
      ending = i;
    }
  if (ending) return shown(*ending);
  const std::string near = nearest_names(entries, choice);
  return "no dataset '" + std::string(choice) + "'" + (near.empty() ? "" : "; the nearest ones are " + near);
}

std::string shape_text(std::span<const std::uint64_t> shape) {
  if (shape.empty()) return "1 value";
  std::string text;
  for (const std::uint64_t size : shape) text += (text.empty() ? "" : " x ") + std::to_string(size);
  return text;
}

void write_datasets(TransferWriter& to, const DatasetList& list) {
  const std::size_t count = std::min(list.entries.size(), kMostListed);
  to.value<std::uint64_t>(count);
  for (const DatasetEntry& entry : std::span(list.entries).first(count)) {
    to.text(entry.path);
    to.list(entry.shape);
    to.text(entry.type);
    to.text(entry.unit);
    to.text(entry.axes);
    to.text(entry.note);
    to.value(entry.form);
    to.value(std::array<std::uint8_t, 2>{entry.is_minor, entry.has_globe});
  }
  to.text(list.shown);
  to.value(list.components);
  to.value<std::uint64_t>(list.component_names.size());
  for (const std::string& name : list.component_names) to.text(name);
  to.value(list.channels);
  to.list(list.times);
  to.value(std::array{list.range.first, list.range.second});
}

DatasetList read_datasets(TransferReader& from) {
  constexpr std::size_t kLeastEntry = 51, kLeastName = 8, kMostNames = 1024;  // bytes; names
  DatasetList list;
  const std::size_t count = from.count(kLeastEntry);
  require_possible(count <= kMostListed);
  list.entries.resize(count);
  for (DatasetEntry& entry : list.entries) {
    entry.path = from.text();
    entry.shape = from.list<std::uint64_t>();
    entry.type = from.text();
    entry.unit = from.text();
    entry.axes = from.text();
    entry.note = from.text();
    const auto form = from.value<std::uint8_t>();
    require_possible(form <= static_cast<std::uint8_t>(DatasetForm::mesh));
    entry.form = static_cast<DatasetForm>(form);
    const auto truths = from.value<std::array<std::uint8_t, 2>>();
    entry.is_minor = truths[0] != 0;
    entry.has_globe = truths[1] != 0;
  }
  list.shown = from.text();
  list.components = from.value<std::uint64_t>();
  const std::size_t names = from.count(kLeastName);
  require_possible(names <= kMostNames);
  for (std::size_t i = 0; i < names; ++i) list.component_names.push_back(from.text());
  list.channels = from.value<std::uint64_t>();
  list.times = from.list<double>();
  const auto range = from.value<std::array<double, 2>>();
  list.range = {range[0], range[1]};
  require_possible(list.components >= 1 && list.channels >= 1 && std::isfinite(range[0]) && std::isfinite(range[1]) &&
                   std::ranges::all_of(list.times, [](double time) { return std::isfinite(time); }));
  return list;
}

}  // namespace gs::app
