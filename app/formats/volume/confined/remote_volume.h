#pragma once

#include "app/confined/decoder_process.h"
#include "app/formats/volume/confined/confined_list.h"
#include "app/formats/volume/confined/file_requests.h"
#include "app/formats/volume/confined/volume_transfer.h"
#include "app/formats/volume/volume.h"
#include "base/noncopyable.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {

/// Volume with a child that reads its slices. The child works ahead: while a reader uses slices, it reads the next ones of the
/// same source. Any thread.
class RemoteVolume : NonCopyable {
 public:
  /// `files` reads the files of a container as long as slices are read; `read_beside` only while the volume is opened.
  RemoteVolume(std::string program, std::string path, SharedBytes file, VolumeRequest request, ReadFile read_beside,
               FileBatches files, const WorldBudget& budget);
  ~RemoteVolume();

  /// Opens the volume in a child. Returns its sources, which `self` owns; or a message without the file name.
  [[nodiscard]] static std::variant<qnv::VolumeSource, std::string> open(const std::shared_ptr<RemoteVolume>& self);
  /// Lists the datasets of the file in a child, for a request that `lists`.
  [[nodiscard]] ListedDatasets list();
  /// Reads a slice of a source. Returns false on failure.
  [[nodiscard]] bool read(std::size_t source, std::uint32_t slice, std::span<std::byte> to);
  /// Reads the voxels of a box of a source. Returns false on failure.
  [[nodiscard]] bool read_box(std::size_t source, const qnv::VoxelBox& box, std::span<std::byte> to);
  /// Returns a message about parts that could not be read so far; empty if there are none.
  [[nodiscard]] std::string trouble() const;
  /// Ends the child, unless a thread reads. The next read starts it again. Returns true if it has ended.
  [[nodiscard]] bool park();

 private:
  static constexpr std::size_t kSlots = 8;

  /// Consecutive slices of a source in the memory for results.
  struct Slot {
    std::size_t source = 0;
    std::uint32_t first = 0, count = 0;
    std::uint32_t used = 0;  // slices that were read
    std::uint64_t last_use = 0;
    [[nodiscard]] bool holds(std::size_t of, std::uint32_t slice) const {
      return source == of && slice >= first && slice - first < count;
    }
  };
  /// Source, and how it was read so far.
  struct Source {
    std::size_t slice_bytes = 0;
    std::uint32_t slices = 0;
    std::uint32_t next = 0;    // slice behind the one that was read last
    std::uint32_t ahead = 1;   // slices of the next request, if it continues
    std::uint32_t wasted = 0;  // requests ahead of which some slices were not used
  };

  /// Starts the child and opens the volume there. Returns the bytes of its reply, or the error.
  [[nodiscard]] std::variant<std::vector<std::byte>, std::string> start();
  /// Starts a child that has ended on purpose. Returns false if it does not give the same reply as before.
  [[nodiscard]] bool restart();
  /// Sends a request for slices. Returns null if the child has ended.
  [[nodiscard]] Slot* request(std::size_t source, std::uint32_t first, std::uint32_t count);
  /// Waits for an answer of the child, and gives it the files for which it asks. Returns null if the child has ended.
  [[nodiscard]] std::optional<DecodeAnswer> next_answer();
  /// Waits for the answer to the last request for slices. Returns false if the child has ended, or could not read the slices.
  [[nodiscard]] bool await();
  /// Requests the slices behind a slot, if the source is read in order.
  void work_ahead(const Slot& slot);
  [[nodiscard]] Slot* slot_of(std::size_t source, std::uint32_t slice);
  [[nodiscard]] std::uint32_t most_ahead(const Source& source) const;
  void forget_slots();

  const std::string program_, path_;
  const SharedBytes file_;
  const VolumeRequest request_;
  const WorldBudget budget_;
  mutable std::mutex mutex_;  // guards the rest
  FileBatches files_;
  std::string trouble_;
  ReadFile read_beside_;  // until the volume is open
  std::unique_ptr<DecoderProcess> process_;
  std::vector<std::pair<std::string, BytesResult>> given_;  // files that the child asked for
  std::vector<std::byte> reply_;
  Share held_;
  std::vector<Source> sources_;
  std::vector<Slot> slots_;
  std::optional<std::size_t> pending_;  // slot of the request without an answer
  std::size_t slot_bytes_ = 0;
  std::uint64_t uses_ = 0;
  bool failed_ = false;
};

}  // namespace gs::app
