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

/// Is this a build with the thread sanitizer? Its shadow memory are files, which a limit on the
/// size of files cuts short.
#if defined(FLEXMORPH_SANITIZES_THREADS)
constexpr bool kThreadSanitized = true;
#else
constexpr bool kThreadSanitized = false;
#endif

/// Is this a build with a sanitizer? It maps terabytes of shadow memory, so that no address space
/// can be limited, and takes many times as long.
#if defined(FLEXMORPH_SANITIZES_ADDRESSES)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = kThreadSanitized;
#endif

}  // namespace flexmorph
