#pragma once

#include <string>
#include <string_view>

namespace flexmorph::io {

/// Time at which a file is stored on the disk: `now` means before the call returns, together with
/// its name in its folder, so that the machine may be switched off; `later` means when the
/// operating system decides. The process may be killed in both cases.
enum class Sync { later, now };

/// Writes a whole file under a temporary name and renames it, so that readers see either the old or
/// the new contents. The folder must exist, because files that are written during a run must not
/// create a folder that was removed.
/// @throws Error (numerical) with the file and the reason.
void write_file(const std::string& path, std::string_view contents, Sync sync = Sync::later);

/// Stores an existing file on the disk, together with its name in its folder.
/// @throws Error (numerical) with the file and the reason; a network disk may report here that it
///         failed to store data it had accepted.
void sync_file(const std::string& path);

/// Returns the contents of a file, even if it grows meanwhile.
/// @param what  the expected contents for messages, such as "a table"
/// @throws Error (input) for a file that cannot be read, and for folders, pipes and devices, which
///         may never end.
std::string read_regular_file(const std::string& path, const std::string& what);

/// Returns the shortest decimal text from which the number can be read back exactly, in every
/// locale ("0.1", "1e-05", "nan", "inf").
std::string to_text(double value);
std::string to_text(long long value);
/// Returns an integer as decimal text.
inline std::string to_text(int value) { return to_text(static_cast<long long>(value)); }

/// Returns a number with `digits` significant digits, for messages and plots ("0.0312", "1.2e-05").
std::string to_text(double value, int digits);

}  // namespace flexmorph::io
