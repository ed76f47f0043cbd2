#pragma once

#include <string>
#include <string_view>

namespace flexmorph::io {

/// Is a file on the disk when a call returns, with its name in its folder, so that a machine may be
/// switched off? Otherwise when the system likes; a process may be killed in either case.
enum class Sync { later, now };

/// Writes a whole file under a temporary name and renames it, so that a reader sees either the old
/// or the new contents. Directories on the way are there: what is written beside a run must not
/// bring back a folder that was removed.
/// @throws Error (numerical) naming the file and the reason: what was computed stays.
void write_file(const std::string& path, std::string_view contents, Sync sync = Sync::later);

/// Brings a file that is there to the disk, with its name in its folder.
/// @throws Error (numerical) likewise: disks of other machines may refuse now what they took.
void sync_file(const std::string& path);

/// All of a file, also when it grows meanwhile.
/// @param what  "a table": what it is to be
/// @throws Error (input) for one that cannot be read, and for folders, pipes and devices, which may
/// never end.
std::string read_regular_file(const std::string& path, const std::string& what);

/// Shortest decimal text that reads back to the same number, whatever the locale ("0.1", "1e-05",
/// "nan", "inf").
std::string to_text(double value);
std::string to_text(long long value);
inline std::string to_text(int value) { return to_text(static_cast<long long>(value)); }

/// `digits` significant digits, for people ("0.0312", "1.2e-05").
std::string to_text(double value, int digits);

}  // namespace flexmorph::io
