#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pdx::io {
/// What a sealed file holds, where, and the hash of every byte of it. A sealed file is an HDF5 file behind a head of
/// kHeadBytes; its last bytes are the text of this. Whoever checks it first need not trust HDF5 with a damaged file.
struct Seal {
  /// 8 knew nothing of what broke where elements are now, 7 held which bonds are left, 6 had options and scene in one
  /// text, 5 no names of rows; 3 was plain HDF5.
  static constexpr int kFormat = 9;
  static constexpr std::size_t kHeadBytes = 512;
  static constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 24; ///< of an extent

  struct Table {
    std::string name; ///< of the dataset: "/displacement"
    std::string type; ///< f64, i32, u64 or u8
    std::int64_t rows = 0, columns = 0;
    std::uint64_t at = 0; ///< first byte in the file
    std::uint64_t bytes() const;
  };
  struct Extent {
    std::uint64_t at = 0, bytes = 0, hash = 0;
  };
  std::vector<Table> tables;
  std::vector<Extent> extents; ///< in order they fill the file from the head to this text

  /// Notes the bytes that stand, or will stand, at a place of the file.
  void cover(std::uint64_t at, std::span<const std::byte> bytes);
  /// Name of the table that a byte of the file belongs to; HDF5's own bytes have none.
  std::string name_at(std::uint64_t at) const;
  std::string text() const;
  /// None if the text does not say, consistently, how a file of `end` bytes without the text is filled.
  static std::optional<Seal> from(std::string_view text, std::uint64_t end);
};

/// The first kHeadBytes of a sealed file: where its table is, and that there is no byte more or less.
struct SealHead {
  int format = Seal::kFormat;
  std::uint64_t table_at = 0, table_bytes = 0, table_hash = 0;

  std::string text() const;
  /// None if the bytes are no head at all; a head of another format says only which.
  static std::optional<SealHead> from(std::string_view bytes);
  bool operator==(const SealHead&) const = default;
};
} // namespace pdx::io
