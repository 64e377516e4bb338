#include "qnv/codecs/values/bricks/received/kept_payloads.h"

namespace gs::qnv::values {

void KeptPayloads::keep(std::uint64_t offset, std::uint64_t owner, std::span<const std::byte> payload) {
  const auto [at, fresh] = kept_.try_emplace(offset);
  if (!fresh) return;
  at->second = {owner, {payload.begin(), payload.end()}};
  bytes_ += payload.size();
  dropped_.erase(offset);
}

void KeptPayloads::trim(const std::function<bool(std::uint64_t owner)>& used) {
  // The last chunks of the stream are the finest, so they go first.
  for (auto at = kept_.end(); bytes_ > most_bytes_ && at != kept_.begin();) {
    --at;
    if (used(at->second.owner)) continue;
    bytes_ -= at->second.payload.size();
    dropped_.insert(at->first);
    at = kept_.erase(at);
  }
}

const std::vector<std::byte>* KeptPayloads::find(std::uint64_t offset) const {
  const auto found = kept_.find(offset);
  return found != kept_.end() ? &found->second.payload : nullptr;
}

}  // namespace gs::qnv::values
