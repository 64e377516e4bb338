#pragma once

#include "net/cells/cell_parity.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::net {

/// Restores lost data datagrams from parity. Returns only restored datagrams with a correct CRC. One thread. Safe for
/// untrusted datagrams.
///
/// Memory: kMaxKept bytes of the newest datagrams, and kMaxParity bytes of parity symbols in kMaxGroups groups.
class CellRebuilder {
 public:
  static constexpr std::size_t kMaxKept = std::size_t{640} << 10, kMaxGroups = 48, kMaxParity = kMaxKept;
  /// Restored datagram.
  struct Rebuilt {
    std::uint64_t number = 0;
    std::vector<Cell> cells;
  };

  /// Takes a received data datagram: its running number and its encoded cells. Appends restored datagrams to `out`.
  void add(std::uint64_t number, std::span<const std::byte> cells, std::vector<Rebuilt>& out);
  /// Takes a received parity datagram. Appends restored datagrams to `out`. Returns the head of the parity, or nullopt
  /// if invalid.
  std::optional<Parity> add_parity(std::uint64_t number, std::span<const Cell> cells, std::vector<Rebuilt>& out);
  /// Reports whether the cells of a datagram hold parity.
  [[nodiscard]] static bool is_parity(std::span<const Cell> cells);
  /// Returns the memory of datagrams and parity symbols, in bytes.
  [[nodiscard]] std::size_t bytes() const { return kept_bytes_ + parity_bytes_; }

 private:
  struct Group {
    std::bitset<kParitySpan> members;
    std::size_t size = 0;  // bytes of each symbol
    bool done = false;
    std::map<std::uint8_t, std::vector<std::byte>> symbols;  // parity symbols by index
  };
  using Groups = std::map<std::uint64_t, Group>;  // by the running number of the first member
  void look(Groups::iterator at, std::vector<Rebuilt>& out);
  void rebuild(std::uint64_t first, const Group& group, std::vector<Rebuilt>& out);
  void forget(Groups::iterator at);
  void keep(std::uint64_t number, std::span<const std::byte> cells);

  std::map<std::uint64_t, std::vector<std::byte>> kept_;
  Groups groups_;
  std::size_t kept_bytes_ = 0, parity_bytes_ = 0;
};

}  // namespace gs::net
