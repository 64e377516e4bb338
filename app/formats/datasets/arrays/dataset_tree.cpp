#include "app/formats/datasets/arrays/dataset_tree.h"

#include "app/formats/volume/volume_common.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace gs::app {
namespace {

template <class T>
void append_doubles(std::span<const std::byte> bytes, std::vector<double>& to) {
  for (std::size_t i = 0; i + sizeof(T) <= bytes.size(); i += sizeof(T)) {
    T value{};
    std::memcpy(&value, bytes.data() + i, sizeof value);
    to.push_back(static_cast<double>(value));
  }
}

}  // namespace

std::string name_of_path(std::string_view path) { return std::string(path.substr(path.rfind('/') + 1)); }

std::string folder_of_path(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  return slash == 0 || slash == std::string_view::npos ? "/" : std::string(path.substr(0, slash));
}

std::string unwritten_problem(ArrayFile& file, std::size_t array, double count) {
  constexpr double kMostUnwritten = 1 << 24;
  if (count <= kMostUnwritten) return {};
  const auto written = file.written(array);
  if (!written || count - static_cast<double>(*written) <= kMostUnwritten) return {};
  return "the file states " + std::to_string(static_cast<std::uint64_t>(count)) + " elements, but at most " +
         std::to_string(*written) + " were written; the file is incomplete, write it again";
}

std::vector<double> doubles_of(NumberType type, std::span<const std::byte> bytes) {
  std::vector<double> numbers;
  if (type == NumberType::none) return numbers;
  numbers.reserve(bytes.size() / size_of(type));
  with_stored_type(static_cast<StoredType>(type), [&](auto kind) { append_doubles<decltype(kind)>(bytes, numbers); });
  return numbers;
}

DatasetTree::DatasetTree(std::shared_ptr<ArrayFile> file, SharedBytes content, WorldBudget budget)
    : file_(std::move(file)), content_(std::move(content)), budget_(std::move(budget)) {
  const auto& all = file_->arrays();
  for (std::size_t i = 0; i < all.size(); ++i) places_.emplace(all[i].path, i);
}

std::optional<std::size_t> DatasetTree::index_of(std::string_view path) const {
  const auto found = places_.find(path);
  return found == places_.end() ? std::nullopt : std::optional(found->second);
}

const ArrayInfo* DatasetTree::find(std::string_view path) const {
  const auto place = index_of(path);
  return place ? &file_->arrays()[*place] : nullptr;
}

bool DatasetTree::has_group(std::string_view path) const {
  const auto& all = file_->groups();
  return std::ranges::find(all, path) != all.end();
}

const ArrayAttribute* DatasetTree::attribute(const std::string& path, std::string_view name) {
  auto found = attributes_.find(path);
  if (found == attributes_.end()) found = attributes_.emplace(path, file_->attributes(path)).first;
  const auto one = std::ranges::find(found->second, name, &ArrayAttribute::name);
  return one == found->second.end() ? nullptr : &*one;
}

std::string DatasetTree::text(const std::string& path, std::string_view name) {
  const ArrayAttribute* const found = attribute(path, name);
  return found && !found->texts.empty() ? found->texts.front() : std::string();
}

std::vector<double> DatasetTree::numbers(const std::string& path, std::string_view name) {
  const ArrayAttribute* const found = attribute(path, name);
  if (!found) return {};
  if (!found->numbers.empty() || found->texts.empty()) return found->numbers;
  constexpr std::size_t kMost = 64;
  return numbers_of(found->texts.front(), kMost);
}

std::optional<double> DatasetTree::number(const std::string& path, std::string_view name) {
  const std::vector<double> all = numbers(path, name);
  return all.empty() ? std::nullopt : std::optional(all.front());
}

const std::vector<double>& DatasetTree::coordinate(const std::string& path) {
  constexpr double kMost = 1 << 24;
  const auto [place, is_new] = coordinates_.try_emplace(path);
  std::vector<double>& kept = place->second;
  const ArrayInfo* const array = is_new ? find(path) : nullptr;
  double count = 1;
  for (const std::uint64_t size : array ? array->shape : std::vector<std::uint64_t>())
    count *= static_cast<double>(size);
  if (!array || array->parts != 1 || count > kMost) return kept;
  auto read = values(path);
  auto* const found = std::get_if<std::vector<double>>(&read);
  if (!found) return kept;
  const double scale = number(path, "scale_factor").value_or(1), offset = number(path, "add_offset").value_or(0);
  for (double& value : *found) value = value * scale + offset;
  kept = std::move(*found);
  return kept;
}

std::variant<std::vector<double>, std::string> DatasetTree::values(const std::string& path) {
  const ArrayInfo* const array = find(path);
  return rows(path, 0, array && !array->shape.empty() ? array->shape.front() : 1);
}

std::variant<std::vector<double>, std::string> DatasetTree::rows(const std::string& path, std::uint64_t first,
                                                                 std::uint64_t count) {
  const auto place = index_of(path);
  if (!place) return "there is no dataset " + path;
  const ArrayInfo& array = file_->arrays()[*place];
  if (!array.problem.empty()) return path + ": " + array.problem;
  if (array.type == NumberType::none) return path + " holds no numbers";
  std::vector<std::uint64_t> from(array.shape.size(), 0), size = array.shape;
  double bytes = static_cast<double>(size_of(array.type)) * array.parts;
  if (!size.empty()) {
    if (first > size[0] || count > size[0] - first) return path + " has too few rows";
    from[0] = first;
    size[0] = count;
  }
  for (const std::uint64_t one : size) bytes *= static_cast<double>(one);
  const auto left = static_cast<double>(budget_->left(Resource::volumes));
  const double needed = bytes + bytes / static_cast<double>(size_of(array.type)) * sizeof(double);
  if (needed > left) return path + ": its numbers need " + budget_->refusal(Resource::volumes);
  const double elements = bytes / static_cast<double>(size_of(array.type)) / array.parts;
  if (std::string problem = unwritten_problem(*file_, *place, elements); !problem.empty()) return path + ": " + problem;
  std::vector<std::byte> raw(static_cast<std::size_t>(bytes));
  if (std::string problem = file_->read(*place, from, size, raw); !problem.empty()) return path + ": " + problem;
  return doubles_of(array.type, raw);
}

}  // namespace gs::app
