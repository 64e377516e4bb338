#include "app/formats/volume/confined/confined_volume.h"

#include "app/base/local_file.h"
#include "app/confined/decoder_pool.h"
#include "app/formats/volume/confined/remote_volume.h"
#include "app/formats/volume/file_states.h"
#include "app/formats/volume/volume_common.h"

#include <utility>

namespace gs::app {

std::variant<qnv::VolumeSource, std::string> open_volume_confined(const std::string& path, const RawVolume& raw,
                                                                  const VolumeOrigin& origin,
                                                                  const WorldBudget& budget) {
  const std::string& program = DecoderPool::of_program().program();
  if (const std::string entry = zarr_entry_of_folder(path); !entry.empty())
    return open_volume_confined(entry, raw, origin, budget);
  if (program.empty()) return open_volume(path, raw, origin, budget);
  auto mapped = map_volume(path);
  if (auto* const problem = std::get_if<std::string>(&mapped)) return std::move(*problem);
  const SharedBytes file = std::get<SharedBytes>(std::move(mapped));
  if (file.file && (origin.component.growing || origin.need)) file.file->tolerate_writes();
  VolumeOrigin own = origin;
  use_folder(path, own);
  note_files(path, file, own);
  VolumeRequest request{path, own.name, raw, own.component, left_of(*budget), false, own.need != nullptr};
  const auto volume = std::make_shared<RemoteVolume>(
      program, path, file, std::move(request), own.read_beside ? own.read_beside : reader_beside(path, {}),
      FileBatches(own.read_files ? own.read_files : files_beside(path, {}),
                  own.read_files ? own.list_folder : lister_beside(path), own.need),
      budget);
  auto opened = RemoteVolume::open(volume);
  if (const auto changed = file.file ? file.file->changed() : std::nullopt) return path + ": " + *changed;
  if (auto* const problem = std::get_if<std::string>(&opened)) return path + ": " + *problem;
  return opened;
}

}  // namespace gs::app
