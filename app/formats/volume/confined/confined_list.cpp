#include "app/formats/volume/confined/confined_list.h"

#include "app/base/local_file.h"
#include "app/confined/decoder_pool.h"
#include "app/formats/common/transfer.h"
#include "app/formats/datasets/dataset_formats.h"
#include "app/formats/volume/confined/remote_volume.h"

#include <cmath>
#include <memory>
#include <utility>

namespace gs::app {
namespace {

enum class ListTag : std::uint8_t { error, list };

}  // namespace

std::vector<std::byte> transfer_bytes(const DatasetList& list) {
  TransferWriter to;
  if (const auto* const problem = std::get_if<std::string>(&list)) {
    to.value(ListTag::error);
    to.text(*problem);
    return to.take();
  }
  const auto& entries = std::get<std::vector<DatasetEntry>>(list);
  to.value(ListTag::list);
  to.value<std::uint64_t>(entries.size());
  for (const DatasetEntry& entry : entries) {
    for (const std::string* const text : {&entry.path, &entry.type, &entry.unit, &entry.axes, &entry.note})
      to.text(*text);
    to.list(entry.shape);
    to.value(entry.form);
    to.value(entry.rank);
    to.value(std::array<std::uint8_t, 2>{entry.is_minor, entry.has_globe});
  }
  return to.take();
}

std::optional<DatasetList> dataset_list_of(std::span<const std::byte> bytes) try {
  TransferReader from(bytes);
  if (from.value<std::uint8_t>() == static_cast<std::uint8_t>(ListTag::error)) return DatasetList(from.text());
  constexpr std::size_t kLeastEntry = 60;  // bytes
  std::vector<DatasetEntry> entries;
  for (std::size_t left = from.count(kLeastEntry); left > 0; --left) {
    DatasetEntry entry;
    for (std::string* const text : {&entry.path, &entry.type, &entry.unit, &entry.axes, &entry.note})
      *text = from.text();
    entry.shape = from.list<std::uint64_t>();
    const auto form = from.value<std::uint8_t>();
    require_possible(form <= static_cast<std::uint8_t>(DatasetForm::mesh));
    entry.form = static_cast<DatasetForm>(form);
    entry.rank = from.value<double>();
    require_possible(std::isfinite(entry.rank));
    const auto truths = from.value<std::array<std::uint8_t, 2>>();
    entry.is_minor = truths[0] != 0;
    entry.has_globe = truths[1] != 0;
    entries.push_back(std::move(entry));
  }
  return DatasetList(std::move(entries));
} catch (const Impossible&) {
  return std::nullopt;
}

DatasetList list_in_child(const std::string& path, const SharedBytes& file, const VolumeOrigin& origin,
                          const WorldBudget& budget) {
  return list_datasets(VolumeFile{path, origin.name.empty() ? file_name(path) : origin.name, file, origin.read_beside,
                                  budget, origin.component, origin.read_files, origin.list_folder});
}

DatasetList list_datasets_confined(const std::string& path, const VolumeOrigin& origin, const WorldBudget& budget) {
  auto mapped = map_volume(path);
  if (auto* const problem = std::get_if<std::string>(&mapped)) return std::move(*problem);
  const SharedBytes file = std::get<SharedBytes>(std::move(mapped));
  VolumeOrigin own = origin;
  use_folder(path, own);
  if (!own.read_beside) own.read_beside = reader_beside(path, {});
  if (!own.read_files) {
    own.read_files = files_beside(path, {});
    own.list_folder = lister_beside(path);
  }
  const std::string& program = DecoderPool::of_program().program();
  if (program.empty()) return list_in_child(path, file, own, budget);
  VolumeRequest request{path, own.name, {}, own.component, left_of(*budget), true};
  return std::make_shared<RemoteVolume>(program, path, file, std::move(request), own.read_beside,
                                        FileBatches(own.read_files, own.list_folder), budget)
      ->list();
}

}  // namespace gs::app
