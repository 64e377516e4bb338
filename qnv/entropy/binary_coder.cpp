#include "qnv/entropy/binary_coder.h"

#include <utility>

namespace gs::qnv::displaced {

void BinaryEncoder::shift() {
  if (low_ < 0xff000000u || low_ >> 32 != 0) {
    const auto carry = static_cast<std::uint8_t>(low_ >> 32);
    if (!first_) bytes_.push_back(static_cast<std::byte>(cache_ + carry));
    for (; pending_ > 0; --pending_) bytes_.push_back(static_cast<std::byte>(0xff + carry));
    cache_ = static_cast<std::uint8_t>(low_ >> 24);
    first_ = false;
  } else {
    ++pending_;
  }
  low_ = (low_ & 0x00ffffff) << 8;
}

std::vector<std::byte> BinaryEncoder::finish() {
  low_ = shortest_number(low_, range_);
  for (int i = 0; i < 5; ++i) shift();
  for (std::size_t i = 0; i < kSparedZeros && !bytes_.empty() && bytes_.back() == std::byte{0}; ++i) bytes_.pop_back();
  return std::move(bytes_);
}

}  // namespace gs::qnv::displaced
