#include "app/formats/volume/confined/remote_volume.h"

#include "app/formats/volume/confined/confined_volume.h"
#include "app/formats/volume/volume_common.h"
#include "net/files/file.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace gs::app {
namespace {

constexpr std::chrono::minutes kOpenPatience{10};   // the limits of a world stop it earlier
constexpr std::chrono::seconds kSlicePatience{60};  // for the slices of a request
constexpr std::size_t kMostAskedFiles = 10'000;     // files that one header may ask for
constexpr std::size_t kMostBatchedFiles = 1'000'000;  // files of a container, while it is opened or slices are read
constexpr std::size_t kAheadBytes = std::size_t{1} << 20;
constexpr std::size_t kMostAhead = 64;
constexpr std::uint32_t kMostWasted = 2;
constexpr const char* kImpossible = "the process that read it gave an impossible result";

/// Volumes that have a child, the one that was used last in front.
class VolumeChildren {
 public:
  static VolumeChildren& of_program() {
    static VolumeChildren the_children;
    return the_children;
  }
  /// Moves a volume with a child to the front. Ends the child of another volume if there are too many.
  void use(RemoteVolume* volume) {
    const std::lock_guard lock(mutex_);
    if (!all_.empty() && all_.front() == volume) return;
    std::erase(all_, volume);
    all_.insert(all_.begin(), volume);
    for (std::size_t i = all_.size(); i-- > 1 && all_.size() > kMostVolumeChildren;)
      if (all_[i]->park()) all_.erase(all_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  void remove(RemoteVolume* volume) {
    const std::lock_guard lock(mutex_);
    std::erase(all_, volume);
  }

 private:
  std::mutex mutex_;
  std::vector<RemoteVolume*> all_;
};

}  // namespace

RemoteVolume::RemoteVolume(std::string program, std::string path, SharedBytes file, VolumeRequest request,
                           ReadFile read_beside, FileBatches files, const WorldBudget& budget)
    : program_(std::move(program)),
      path_(std::move(path)),
      file_(std::move(file)),
      request_(std::move(request)),
      budget_(budget),
      files_(std::move(files)),
      read_beside_(std::move(read_beside)) {}

RemoteVolume::~RemoteVolume() { VolumeChildren::of_program().remove(this); }

std::variant<std::vector<std::byte>, std::string> RemoteVolume::start() {
  constexpr std::uint64_t kWorkingMemory = std::uint64_t{1} << 30;
  const int descriptor = file_.file ? file_.file->descriptor() : -1;
  const std::uint64_t memory = std::max(DecoderProcess::kMemory, budget_->limits().memory + kWorkingMemory);
  const DecoderKind kind = needs_dataset_module(path_, file_.bytes) ? DecoderKind::datasets : DecoderKind::volumes;
  process_ = std::make_unique<DecoderProcess>(program_, kind, descriptor, memory);
  files_.begin_child();
  const std::vector<std::byte> head = transfer_bytes(request_);
  if ((descriptor < 0 && !process_->load(file_.bytes)) || !process_->put_result(head))
    return std::string("no memory to read it");
  DecodeRequest request = request_of(DecodeOperation::open_data, 0);
  request.count = head.size();
  const auto stopped = [this] { return budget_->stopped(); };
  auto answered = process_->ask(request, stopped, kOpenPatience);
  std::size_t asked = 0;
  while (const auto* const answer = std::get_if<DecodeAnswer>(&answered)) {
    if (answer->good != DecodeAnswer::kAsksForFile) break;
    const std::string reference = error_in(*answer);
    if (is_file_request(reference)) {
      const auto files = ++asked > kMostBatchedFiles ? std::nullopt : files_.answer(reference);
      if (!files) return std::string("it asks for impossible files");
      answered = process_->give_file(*files, stopped, kOpenPatience);
      continue;
    }
    if (++asked > kMostAskedFiles) return std::string("it refers to too many files");
    auto known = std::ranges::find(given_, reference, &std::pair<std::string, BytesResult>::first);
    if (known == given_.end())
      known = given_.emplace(known, reference, read_beside_ ? read_beside_(reference) : BytesResult("not known"));
    answered = process_->give_file(known->second, stopped, kOpenPatience);
  }
  if (auto* const error = std::get_if<render::ImageError>(&answered)) return std::move(error->message);
  auto bytes = process_->take_bytes(std::get<DecodeAnswer>(answered), stopped, kOpenPatience, budget_->limits().memory);
  if (auto* const error = std::get_if<render::ImageError>(&bytes)) return std::move(error->message);
  return std::move(std::get<std::vector<std::byte>>(bytes));
}

ListedDatasets RemoteVolume::list() {
  const std::lock_guard lock(mutex_);
  auto started = start();
  if (auto* const error = std::get_if<std::string>(&started)) return std::move(*error);
  auto list = listed_datasets_of(std::get<std::vector<std::byte>>(started));
  return list ? std::move(*list) : ListedDatasets(kImpossible);
}

std::variant<qnv::VolumeSource, std::string> RemoteVolume::open(const std::shared_ptr<RemoteVolume>& self) {
  const std::lock_guard lock(self->mutex_);
  VolumeChildren::of_program().use(self.get());
  auto started = self->start();
  self->read_beside_ = nullptr;  // the caller owns what it uses
  if (auto* const error = std::get_if<std::string>(&started)) return std::move(*error);
  self->reply_ = std::move(std::get<std::vector<std::byte>>(started));
  const MakeSliceReader make = [&self](std::size_t number, const qnv::VolumeLayout&) {
    return [self, number](std::uint32_t z, std::span<std::byte> to) { return self->read(number, z, to); };
  };
  const MakeBoxReader make_box = [&self](std::size_t number) {
    return [self, number](const qnv::VoxelBox& box, std::span<std::byte> to) { return self->read_box(number, box, to); };
  };
  auto reply = volume_reply_of(self->reply_, make, make_box);
  if (!reply) return std::string(kImpossible);
  if (self->request_.component.found) *self->request_.component.found = std::move(reply->datasets);
  if (auto* const error = std::get_if<std::string>(&reply->volume)) {
    // The child states the name of the file in front.
    if (error->starts_with(self->path_ + ": ")) error->erase(0, self->path_.size() + 2);
    return std::move(*error);
  }
  auto& volume = std::get<qnv::VolumeSource>(reply->volume);
  if (auto problem = too_large_slices(volume.layout, *self->budget_)) return std::move(*problem);
  self->held_ = Share(self->budget_, Resource::volumes);
  if (!self->held_.grow(reply->held)) return "its voxels are " + self->budget_->refusal(Resource::volumes);
  volume.trouble = [self] { return self->trouble(); };
  self->slot_bytes_ = kAheadBytes;
  for (const qnv::VolumeSource* const source : numbered_sources(volume)) {
    Source known;
    known.slices = source->layout.dimensions[2];
    known.slice_bytes = qnv::slice_voxels(source->layout) * qnv::size_of(source->layout.type);
    self->slot_bytes_ = std::max(self->slot_bytes_, known.slice_bytes);
    self->sources_.push_back(known);
  }
  return std::move(volume);
}

std::string RemoteVolume::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

bool RemoteVolume::restart() {
  const auto started = start();
  const auto* const reply = std::get_if<std::vector<std::byte>>(&started);
  if (!reply || *reply != reply_) return false;
  const auto again = volume_reply_of(*reply, [](std::size_t, const qnv::VolumeLayout&) { return nullptr; });
  return again && held_.grow(again->held);
}

bool RemoteVolume::park() {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return false;
  process_.reset();
  forget_slots();
  held_.shrink_to(0);
  return true;
}

void RemoteVolume::forget_slots() {
  slots_.clear();
  pending_.reset();
}

RemoteVolume::Slot* RemoteVolume::slot_of(std::size_t source, std::uint32_t slice) {
  const auto found = std::ranges::find_if(slots_, [&](const Slot& slot) { return slot.holds(source, slice); });
  return found == slots_.end() ? nullptr : &*found;
}

std::uint32_t RemoteVolume::most_ahead(const Source& source) const {
  return static_cast<std::uint32_t>(std::clamp<std::size_t>(kAheadBytes / source.slice_bytes, 1, kMostAhead));
}

RemoteVolume::Slot* RemoteVolume::request(std::size_t source, std::uint32_t first, std::uint32_t count) {
  if (pending_) (void)await();
  if (!process_->good()) return nullptr;
  // Large slices have few slots, so that they take little memory.
  const std::size_t most = slot_bytes_ > kAheadBytes ? 2 : kSlots;
  std::size_t at = slots_.size();
  if (slots_.size() < most) {
    slots_.emplace_back();
  } else {
    at = static_cast<std::size_t>(std::ranges::min_element(slots_, {}, &Slot::last_use) - slots_.begin());
    // Slices that nobody used: the source is not read in order, or too many are.
    if (const Slot& old = slots_[at]; old.used < old.count) ++sources_[old.source].wasted;
  }
  Slot& slot = slots_[at];
  slot = {source, first, count, 0, ++uses_};
  DecodeRequest request = request_of(DecodeOperation::read_slices, sources_[source].slice_bytes);
  request.source = source;
  request.first = first;
  request.count = count;
  request.offset = at * slot_bytes_;
  if (!process_->begin(request, (at + 1) * slot_bytes_)) {
    slot.count = 0;  // the memory holds no slices of it
    return nullptr;
  }
  pending_ = at;
  return &slot;
}

std::optional<DecodeAnswer> RemoteVolume::next_answer() {
  const auto stopped = [this] { return budget_->stopped(); };
  auto answered = process_->await_answer(stopped, kSlicePatience);
  const auto* answer = std::get_if<DecodeAnswer>(&answered);
  for (std::size_t asked = 0; answer && answer->good == DecodeAnswer::kAsksForFile; ++asked) {
    const std::string text = error_in(*answer);
    const auto files = asked < kMostBatchedFiles && is_file_request(text) ? files_.answer(text) : std::nullopt;
    if (!files) {
      failed_ = true;
      return std::nullopt;
    }
    answered = process_->give_file(*files, stopped, kSlicePatience);
    answer = std::get_if<DecodeAnswer>(&answered);
  }
  if (answer && answer->good == 1 && answer->text[0] != 0) trouble_ = error_in(*answer);
  return answer ? std::optional(*answer) : std::nullopt;
}

bool RemoteVolume::await() {
  const std::size_t at = *pending_;
  pending_.reset();
  const auto answer = next_answer();
  Slot& slot = slots_[at];
  const std::uint64_t read = answer && answer->good == 1 ? answer->count : 0;
  slot.count = static_cast<std::uint32_t>(std::min<std::uint64_t>(slot.count, read));
  return slot.count > 0;
}

void RemoteVolume::work_ahead(const Slot& slot) {
  const Source& source = sources_[slot.source];
  const std::uint32_t next = slot.first + slot.count;
  if (source.wasted > kMostWasted || next >= source.slices || slot_of(slot.source, next)) return;
  if (pending_ && !process_->has_answer()) return;
  (void)request(slot.source, next, std::min(source.ahead, source.slices - next));
}

bool RemoteVolume::read(std::size_t number, std::uint32_t slice, std::span<std::byte> to) {
  const std::lock_guard lock(mutex_);
  if (failed_ || number >= sources_.size()) return false;
  Source& source = sources_[number];
  if (slice >= source.slices || to.size() != source.slice_bytes) return false;
  VolumeChildren::of_program().use(this);
  if (!process_ && !restart()) {
    failed_ = true;
    return false;
  }
  const bool in_order = slice == std::exchange(source.next, slice + 1) && slice > 0;
  Slot* slot = slot_of(number, slice);
  if (!slot) {
    source.ahead = in_order && source.wasted <= kMostWasted ? std::min(source.ahead * 2, most_ahead(source)) : 1;
    slot = request(number, slice, std::min(source.ahead, source.slices - slice));
  }
  const auto at = slot ? static_cast<std::size_t>(slot - slots_.data()) : slots_.size();
  const bool there = slot && (pending_ != at || await());
  const auto results = there ? process_->results((at + 1) * slot_bytes_) : std::span<const std::byte>();
  if (results.empty()) {
    failed_ = failed_ || !process_->good();
    return false;
  }
  const std::size_t offset = at * slot_bytes_ + (slice - slot->first) * source.slice_bytes;
  const bool first = slot->used++ == 0;
  slot->last_use = ++uses_;
  if (first && in_order) {
    source.ahead = std::min(source.ahead * 2, most_ahead(source));
    work_ahead(*slot);
  }
  std::memcpy(to.data(), results.data() + offset, to.size());
  return true;
}

bool RemoteVolume::read_box(std::size_t number, const qnv::VoxelBox& box, std::span<std::byte> to) {
  const std::lock_guard lock(mutex_);
  if (failed_ || number >= sources_.size() || to.empty()) return false;
  VolumeChildren::of_program().use(this);
  if (!process_ && !restart()) {
    failed_ = true;
    return false;
  }
  if (pending_) (void)await();
  // Boxes use the memory of the slots.
  forget_slots();
  if (!process_->good()) return false;
  DecodeRequest request = request_of(DecodeOperation::read_box, to.size());
  request.source = number;
  request.box = numbers_of(box);
  if (!process_->begin(request, to.size())) return false;
  const auto answer = next_answer();
  if (!answer || answer->good != 1) {
    failed_ = failed_ || !process_->good();
    return false;
  }
  const auto results = process_->results(to.size());
  if (results.size() != to.size()) return false;
  std::memcpy(to.data(), results.data(), to.size());
  return true;
}

}  // namespace gs::app
