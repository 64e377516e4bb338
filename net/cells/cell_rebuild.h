#pragma once

#include "net/cells/cell_parity.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::net {

/// Restores lost data datagrams from parity. Returns only restored datagrams with the right CRC. Memory: kMaxKept
/// bytes of the newest datagrams, and kMaxParity bytes of parity symbols in kMaxGroups groups. One thread. Safe for
/// untrusted datagrams.
class CellRebuilder {
 public:
  static constexpr std::size_t kMaxKept = std::size_t{640} << 10, kMaxGroups = 48, kMaxParity = kMaxKept;
  /// Restored datagram.
  struct Rebuilt {
    std::uint64_t number = 0;
    std::vector<Cell> cells;
  };

  /// Takes a received data datagram: its running number and its cells on the wire.
  void add(std::uint64_t number, std::span<const std::byte> cells, std::vector<Rebuilt>& out);
  /// Takes a received parity datagram. Returns its head if it is valid.
  std::optional<Parity> add_parity(std::uint64_t number, std::span<const Cell> cells, std::vector<Rebuilt>& out);
  /// Reports whether the cells of a datagram are parity.
  [[nodiscard]] static bool is_parity(std::span<const Cell> cells);
  /// Returns the held bytes of cells and symbols.
  [[nodiscard]] std::size_t bytes() const { return kept_bytes_ + parity_bytes_; }

 private:
  struct Group {
    std::bitset<kParitySpan> members;
    std::size_t size = 0;  // bytes of a symbol
    bool done = false;
    std::map<std::uint8_t, std::vector<std::byte>> symbols;  // parity
  };
  using Groups = std::map<std::uint64_t, Group>;  // key: first running number
  void look(Groups::iterator at, std::vector<Rebuilt>& out);
  void rebuild(std::uint64_t first, const Group& group, std::vector<Rebuilt>& out);
  void forget(Groups::iterator at);
  void keep(std::uint64_t number, std::span<const std::byte> cells);

  std::map<std::uint64_t, std::vector<std::byte>> kept_;
  Groups groups_;
  std::size_t kept_bytes_ = 0, parity_bytes_ = 0;
};

}  // namespace gs::net
