#include "app/encode/encode_spill.h"

#include "net/files/file.h"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {

bool EncodeSpill::append(std::span<const std::byte> bytes) {
  if (!file_ && memory_.size() + bytes.size() <= most_bytes_) return memory_.append(bytes);
  if (!file_ && !move_to_file()) return false;
  if (file_->append(bytes)) return true;
  problem_ = file_->problem();
  return false;
}

bool EncodeSpill::move_to_file() {
  auto made = net::TemporaryFile::create(folder_);
  if (auto* problem = std::get_if<net::FileError>(&made)) {
    problem_ = std::move(problem->message);
    return false;
  }
  auto& file = std::get<net::TemporaryFile>(made);
  std::vector<std::byte> piece(std::size_t{1} << 20);
  for (std::uint64_t at = 0; at < memory_.size(); at += piece.size()) {
    piece.resize(static_cast<std::size_t>(std::min<std::uint64_t>(piece.size(), memory_.size() - at)));
    if (!memory_.read(at, piece) || !file.append(piece)) {
      problem_ = file.problem();
      return false;
    }
  }
  memory_ = {};
  file_ = std::move(file);
  return true;
}

bool EncodeSpill::read(std::uint64_t offset, std::span<std::byte> to) const {
  return file_ ? file_->read(offset, to) : memory_.read(offset, to);
}

}  // namespace gs::app
