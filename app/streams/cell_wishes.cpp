#include "app/streams/cell_wishes.h"

#include "net/cells/cell_receiver.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/container/container.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

constexpr std::size_t kMaxEarlyBytes = std::size_t{16} << 20;
constexpr std::size_t kBeside = 32;  // chunks that are requested with one of the directory, about as many bytes
constexpr std::chrono::seconds kPatience{10};

// Returns the header of a stream and its length; nullopt if it is incomplete.
std::optional<std::pair<qnv::StreamHeader, std::size_t>> header_of(std::span<const std::byte> front) {
  std::size_t header_bytes = 0;
  bool need_more = false;
  auto decoded = qnv::decode_header(front, header_bytes, need_more);
  auto* const header = std::get_if<qnv::StreamHeader>(&decoded);
  if (!header || need_more) return std::nullopt;
  return std::pair(std::move(*header), header_bytes);
}

// Returns the number of chunks in the first bytes of a stream.
std::size_t chunks_in(std::span<const std::byte> front, std::size_t header_bytes) {
  std::size_t count = 0;
  std::span<const std::byte> rest = front.subspan(std::min(header_bytes, front.size()));
  for (auto head = qnv::chunk_head(rest); head && head->bytes <= rest.size(); head = qnv::chunk_head(rest)) {
    ++count;
    rest = rest.subspan(head->bytes);
  }
  return count;
}

}  // namespace

net::ChunkName cell_of_number(std::size_t number) {
  const std::size_t part = number / net::kMaxChunks;
  return {static_cast<std::uint8_t>(part == 0 ? 0 : kPlacesStream + part),
          static_cast<std::uint32_t>(number % net::kMaxChunks)};
}

std::size_t number_of_cell(const net::ChunkName& name) {
  const std::size_t part = name.stream <= kPlacesStream ? 0 : std::size_t{name.stream} - kPlacesStream;
  return part * net::kMaxChunks + name.chunk;
}

std::vector<std::uint32_t> cells_of_numbers(std::size_t numbers, std::size_t places) {
  const auto most = [](std::size_t count) {
    return static_cast<std::uint32_t>(std::min<std::size_t>(count, net::kMaxChunks));
  };
  std::vector<std::uint32_t> streams = {most(numbers), most(places)};
  for (std::size_t from = net::kMaxChunks; from < numbers; from += net::kMaxChunks)
    streams.push_back(most(numbers - from));
  return streams;
}

CellWishes::CellWishes(std::shared_ptr<StreamFeed> feed, std::span<const std::byte> base, std::uint32_t places)
    : feed_(std::move(feed)), places_(places) {
  const auto header = header_of(base);
  if (!header) return;
  first_ = chunks_in(base, header->second);
  general_ = !header->first.steps.times.empty() || header->first.grid.components > 1;
}

bool CellWishes::suits(const StreamFeed& feed, std::span<const std::byte> base) {
  if (feed.takes_bytes()) return true;
  const auto header = header_of(base);
  return header && !header->first.steps.times.empty() && !feed.requests()->in_stream_order();
}

std::string CellWishes::take(const net::ChunkName& name, std::vector<std::byte> chunk) {
  latest_ = Clock::now();
  if (name.stream == kPlacesStream) {
    if (name.chunk < places_.size() && places_[name.chunk].empty()) places_[name.chunk] = std::move(chunk);
    return read_places();
  }
  pass(number_of_cell(name), std::move(chunk));
  return {};
}

// Reads the next chunk of the directory. Returns false if it is invalid.
bool CellWishes::read_part(std::span<const std::byte> chunk) {
  const auto parsed = qnv::sound_chunk(chunk);
  const auto* const sound = std::get_if<qnv::SoundChunk>(&parsed);
  if (!sound) return false;
  if (general_ && sound->type == qnv::ChunkType::directory) {
    for (const qnv::DirectoryEntry& entry : qnv::decode_directory(sound->payload, feed_->box())) {
      if (!offsets_.empty() && entry.offset <= offsets_.back()) return false;
      offsets_.push_back(entry.offset);
    }
    return true;
  }
  if (sound->type != qnv::ChunkType::places || !reader_.add(sound->payload)) return false;
  for (std::size_t i = offsets_.size(); i < reader_.places().size(); ++i)
    offsets_.push_back(reader_.places()[i].offset);
  return true;
}

// Reads the chunks of the directory in order, as far as they were received.
std::string CellWishes::read_places() {
  if (has_all_places()) return {};
  const std::size_t before = next_place_;
  for (; next_place_ < places_.size() && !places_[next_place_].empty(); ++next_place_) {
    if (!read_part(places_[next_place_])) return "its directory is invalid";
  }
  if (next_place_ == before) return {};
  changed_ = true;
  if (has_all_places()) {
    reader_ = {};
    std::vector<std::byte> all;
    for (std::vector<std::byte>& part : places_) {
      all.insert(all.end(), part.begin(), part.end());
      part = {};
    }
    if (!feed_->set_directory(std::move(all))) return "its directory is invalid";
  }
  pass_early();
  return {};
}

void CellWishes::pass_early() {
  for (auto& [number, chunk] : std::exchange(early_, {})) pass(number, std::move(chunk));
  if (early_.empty()) early_bytes_ = 0;
}

// Notes that a chunk was received.
void CellWishes::note(std::size_t number) {
  if (taken_.size() <= number) taken_.resize(number + 1);
  taken_[number] = true;
  ++received_;
  open_ -= std::min<std::size_t>(open_, 1);
}

// Passes a chunk on if its offset is known. Else keeps it until then.
void CellWishes::pass(std::size_t number, std::vector<std::byte> chunk) {
  if (number >= kMaxNumbered || (number < taken_.size() && taken_[number])) return;
  if (!feed_->takes_bytes()) {
    note(number);
  } else if (first_ + number < offsets_.size()) {
    note(number);
    feed_->add(offsets_[first_ + number], std::move(chunk));
  } else if (!has_all_places()) {
    early_bytes_ += chunk.size();
    if (early_bytes_ <= kMaxEarlyBytes)
      early_.try_emplace(number, std::move(chunk));
    else
      again_.push_back(cell_of_number(number));
  }
}

bool CellWishes::update() {
  const bool wants = feed_->take_wanted(wanted_);
  if (wants) asked_again_.clear();
  const bool more = wants || (cut_ && open_ == 0);
  if (has_all_places() ? !more : !std::exchange(changed_, false)) return !again_.empty();
  names_.clear();
  cut_ = false;
  if (has_all_places())
    name_wanted();
  else
    name_first();
  latest_ = Clock::now();
  return true;
}

// Views cannot choose chunks before the directory is here. Meanwhile, requests both it and the first chunks.
void CellWishes::name_first() {
  std::size_t number = 0;
  for (std::size_t place = next_place_; place < places_.size(); ++place) {
    if (!places_[place].empty()) continue;
    names_.push_back({kPlacesStream, static_cast<std::uint32_t>(place)});
    for (std::size_t count = 0; count < kBeside && names_.size() < net::CellClient::kMostPreferred; ++number) {
      if ((number < taken_.size() && taken_[number]) || early_.contains(number)) continue;
      names_.push_back(cell_of_number(number));
      ++count;
    }
  }
}

void CellWishes::name_wanted() {
  for (const qnv::ChunkRange& range : wanted_) {
    if (names_.size() >= net::CellClient::kMostPreferred) {
      cut_ = true;
      break;
    }
    const auto at = std::ranges::lower_bound(offsets_, range.offset);
    const auto place = static_cast<std::size_t>(at - offsets_.begin());
    if (at == offsets_.end() || *at != range.offset || place < first_) continue;
    const std::size_t number = place - first_;
    if (number < taken_.size() && taken_[number]) {
      // Of a long stream, chunks may be received, dropped and wanted again.
      if (asked_again_.size() <= number) asked_again_.resize(number + 1);
      if (!range.again || asked_again_[number]) continue;
      asked_again_[number] = true;
      taken_[number] = false;
      --received_;
      again_.push_back(cell_of_number(number));
    }
    names_.push_back(cell_of_number(number));
  }
  open_ = names_.size();
}

bool CellWishes::rests() const {
  if (Clock::now() - latest_ > kPatience) return true;
  return has_all_places() && std::ranges::all_of(names_, [this](const net::ChunkName& name) {
           const std::size_t number = number_of_cell(name);
           return name.stream == kPlacesStream || (number < taken_.size() && taken_[number]) ||
                  first_ + number >= offsets_.size();
         });
}

}  // namespace gs::app
