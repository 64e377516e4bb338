#include "net/cells/erasure.h"

#include <isa-l/erasure_code.h>

#include <algorithm>
#include <cmath>

namespace gs::net {
namespace {

constexpr std::size_t kBlockSource = 64;

/// Returns the coding matrix: rows of the identity, then rows of a Cauchy matrix. Any k of its rows are independent.
std::vector<unsigned char> coding_matrix(std::size_t source) {
  std::vector<unsigned char> matrix(ErasureLayout::kMaxSymbols * source);
  gf_gen_cauchy1_matrix(matrix.data(), static_cast<int>(ErasureLayout::kMaxSymbols), static_cast<int>(source));
  return matrix;
}

unsigned char* raw(std::byte* bytes) { return reinterpret_cast<unsigned char*>(bytes); }

}  // namespace

bool ErasureLayout::sound() const {
  return bytes > 0 && bytes <= kMaxBytes && symbol >= 8 && source > 0 && source <= kMaxSource && blocks() <= 65535;
}

std::size_t ErasureLayout::blocks() const {
  const std::size_t block = std::size_t{symbol} * source;
  return block == 0 ? 0 : (bytes + block - 1) / block;
}

ErasureLayout erasure_layout(std::size_t bytes, std::size_t symbol) {
  const std::size_t symbols = std::max<std::size_t>((bytes + symbol - 1) / symbol, 1);
  const std::size_t blocks = (symbols + kBlockSource - 1) / kBlockSource;
  return {static_cast<std::uint32_t>(bytes), static_cast<std::uint16_t>(symbol),
          static_cast<std::uint8_t>((symbols + blocks - 1) / blocks)};
}

std::size_t symbols_for(std::size_t source, double loss, double failure) {
  std::size_t symbols = source;
  if (loss <= 0) return symbols;
  if (loss >= 1) return ErasureLayout::kMaxSymbols;
  // The n-th sent symbol is the k-th received symbol with probability C(n - 1, k - 1) (1 - loss)^k loss^(n - k).
  // `arrived` sums this over n.
  double last = std::pow(1 - loss, static_cast<double>(source)), arrived = last;
  while (symbols < ErasureLayout::kMaxSymbols && 1 - arrived >= failure) {
    last *= loss * static_cast<double>(symbols) / static_cast<double>(symbols - source + 1);
    arrived += last;
    ++symbols;
  }
  return symbols;
}

ErasureEncoder::ErasureEncoder(std::span<const std::byte> data, ErasureLayout layout)
    : layout_(layout), data_(data.begin(), data.end()), matrix_(coding_matrix(layout.source)) {
  data_.resize(layout.blocks() * layout.source * layout.symbol);
}

std::vector<std::byte> ErasureEncoder::symbol(std::size_t block, std::size_t number) const {
  const std::size_t source = layout_.source, size = layout_.symbol;
  const std::byte* from = data_.data() + block * source * size;
  if (number < source) return {from + number * size, from + (number + 1) * size};
  std::vector<std::byte> result(size);
  std::vector<unsigned char> tables(32 * source);
  ec_init_tables(static_cast<int>(source), 1, const_cast<unsigned char*>(matrix_.data()) + number * source,
                 tables.data());
  std::vector<unsigned char*> sources(source);
  for (std::size_t i = 0; i < source; ++i) sources[i] = raw(const_cast<std::byte*>(from + i * size));
  unsigned char* target = raw(result.data());
  ec_encode_data(static_cast<int>(size), static_cast<int>(source), 1, tables.data(), sources.data(), &target);
  return result;
}

ErasureDecoder::ErasureDecoder(ErasureLayout layout) : layout_(layout), blocks_(layout.blocks()) {}

bool ErasureDecoder::add(std::size_t block, std::size_t number, std::span<const std::byte> symbol) {
  if (block >= blocks_.size() || number >= ErasureLayout::kMaxSymbols || symbol.size() != layout_.symbol) return false;
  Block& at = blocks_[block];
  if (at.done) return false;
  if (!at.symbols.try_emplace(static_cast<std::uint8_t>(number), symbol.begin(), symbol.end()).second) return false;
  if (at.symbols.size() == layout_.source) solve(block);
  if (done()) data_.resize(layout_.bytes);
  return true;
}

void ErasureDecoder::solve(std::size_t number) {
  const std::size_t source = layout_.source, size = layout_.symbol;
  Block& block = blocks_[number];
  if (data_.empty()) data_.resize(blocks_.size() * source * size);
  const std::vector<unsigned char> matrix = coding_matrix(source);
  std::vector<unsigned char> rows(source * source), inverse(source * source), lost_rows;
  std::vector<unsigned char*> sources, targets;
  for (auto& [row, bytes] : block.symbols) {
    std::copy_n(matrix.begin() + static_cast<std::ptrdiff_t>(row * source), source,
                rows.begin() + static_cast<std::ptrdiff_t>(sources.size() * source));
    sources.push_back(raw(bytes.data()));
  }
  // The chosen rows are independent, so the inversion cannot fail.
  if (gf_invert_matrix(rows.data(), inverse.data(), static_cast<int>(source)) != 0) return;
  for (std::size_t i = 0; i < source; ++i) {
    std::byte* const place = data_.data() + (number * source + i) * size;
    if (const auto there = block.symbols.find(static_cast<std::uint8_t>(i)); there != block.symbols.end()) {
      std::copy(there->second.begin(), there->second.end(), place);
      continue;
    }
    const auto row = inverse.begin() + static_cast<std::ptrdiff_t>(i * source);
    lost_rows.insert(lost_rows.end(), row, row + static_cast<std::ptrdiff_t>(source));
    targets.push_back(raw(place));
  }
  if (!targets.empty()) {
    std::vector<unsigned char> tables(32 * source * targets.size());
    ec_init_tables(static_cast<int>(source), static_cast<int>(targets.size()), lost_rows.data(), tables.data());
    ec_encode_data(static_cast<int>(size), static_cast<int>(source), static_cast<int>(targets.size()), tables.data(),
                   sources.data(), targets.data());
  }
  block.done = true;
  block.symbols.clear();
  ++done_;
}

}  // namespace gs::net
