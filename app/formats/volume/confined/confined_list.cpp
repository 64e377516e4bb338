#include "app/formats/volume/confined/confined_list.h"

#include "app/base/local_file.h"
#include "app/confined/decoder_pool.h"
#include "app/formats/common/transfer.h"
#include "app/formats/datasets/dataset_formats.h"
#include "app/formats/volume/confined/remote_volume.h"

#include <memory>
#include <utility>

namespace gs::app {
namespace {

enum class ListTag : std::uint8_t { error, list };

}  // namespace

std::vector<std::byte> transfer_bytes(const ListedDatasets& listed) {
  TransferWriter to;
  if (const auto* const problem = std::get_if<std::string>(&listed)) {
    to.value(ListTag::error);
    to.text(*problem);
  } else {
    DatasetList list;
    list.entries = std::get<std::vector<DatasetEntry>>(listed);
    to.value(ListTag::list);
    write_datasets(to, list);
  }
  return to.take();
}

std::optional<ListedDatasets> listed_datasets_of(std::span<const std::byte> bytes) try {
  TransferReader from(bytes);
  if (from.value<std::uint8_t>() == static_cast<std::uint8_t>(ListTag::error)) return ListedDatasets(from.text());
  return ListedDatasets(read_datasets(from).entries);
} catch (const Impossible&) {
  return std::nullopt;
}

ListedDatasets list_in_child(const std::string& path, const SharedBytes& file, const VolumeOrigin& origin,
                             const WorldBudget& budget) {
  return list_datasets(VolumeFile{path, origin.name.empty() ? file_name(path) : origin.name, file, origin.read_beside,
                                  budget, origin.component, origin.read_files, origin.list_folder});
}

ListedDatasets list_datasets_confined(const std::string& path, const VolumeOrigin& origin, const WorldBudget& budget) {
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
