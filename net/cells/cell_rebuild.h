#pragma once

#include "net/cells/cell_parity.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::net {

/// Rebuilds data datagrams that were lost from parity. Memory: kMostKept
/// bytes of the newest datagrams, and kMostParity of symbols of parity in
/// kMostGroups groups.
/// One thread; safe for untrusted datagrams: what is rebuilt is handed out only
/// with the right CRC.
class CellRebuilder {
 public:
  static constexpr std::size_t kMostKept = std::size_t{640} << 10, kMostGroups = 48, kMostParity = kMostKept;
  /// A datagram as it was.
  struct Rebuilt {
    std::uint64_t number = 0;
    std::vector<Cell> cells;
  };

  /// A datagram of data came: its running number, and its cells on the wire.
  void add(std::uint64_t number, std::span<const std::byte> cells, std::vector<Rebuilt>& out);
  /// A datagram of parity came. Gives its head if that is sound.
  std::optional<Parity> add_parity(std::uint64_t number, std::span<const Cell> cells, std::vector<Rebuilt>& out);
  /// Whether a datagram's cells are parity.
  [[nodiscard]] static bool is_parity(std::span<const Cell> cells);
  /// What is held, in bytes of cells and symbols.
  [[nodiscard]] std::size_t bytes() const { return kept_bytes_ + parity_bytes_; }

 private:
  struct Group {
    std::bitset<kParitySpan> members;
    std::size_t size = 0;  // of a symbol
    bool done = false;
    std::map<std::uint8_t, std::vector<std::byte>> symbols;  // parity
  };
  using Groups = std::map<std::uint64_t, Group>;  // by the first number
  void look(Groups::iterator at, std::vector<Rebuilt>& out);
  void rebuild(std::uint64_t first, const Group& group, std::vector<Rebuilt>& out);
  void forget(Groups::iterator at);
  void keep(std::uint64_t number, std::span<const std::byte> cells);

  std::map<std::uint64_t, std::vector<std::byte>> kept_;
  Groups groups_;
  std::size_t kept_bytes_ = 0, parity_bytes_ = 0;
};

}  // namespace gs::net
