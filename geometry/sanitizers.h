#pragma once

namespace flexmorph {

#if defined(__SANITIZE_THREAD__)
#define FLEXMORPH_SANITIZES_THREADS 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define FLEXMORPH_SANITIZES_THREADS 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define FLEXMORPH_SANITIZES_ADDRESSES 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define FLEXMORPH_SANITIZES_ADDRESSES 1
#endif
#endif

/// True if this is a build with the thread sanitizer. The sanitizer keeps its shadow memory in
/// files, therefore a limit on the size of files must not be set.
#if defined(FLEXMORPH_SANITIZES_THREADS)
constexpr bool kThreadSanitized = true;
#else
constexpr bool kThreadSanitized = false;
#endif

/// True if this is a build with a sanitizer. A sanitizer maps terabytes of shadow memory, therefore
/// the address space must not be limited; and the program runs many times slower.
#if defined(FLEXMORPH_SANITIZES_ADDRESSES)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = kThreadSanitized;
#endif

}  // namespace flexmorph
