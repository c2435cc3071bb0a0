# Build policy as two INTERFACE targets: every target of ours links insitu_policy; nothing else does.
#
# -ffp-contract=off: results that decide a picture are computed in plain double arithmetic, and the same on every
# machine. Fused operations are used where a kernel asks for them. Fast-math is never set: it would link code that
# changes the host's MXCSR.
#
# -fno-tree-slp-vectorize: when GCC 12 joins the statements of an unrolled loop into vectors, it takes double(float(x))
# for x, so that the tail of a number split into two floats becomes 0 and particles far from the origin are missed
# (tests/unit/kernels/compiler_test.cpp).
add_library(insitu_policy INTERFACE)
target_compile_options(insitu_policy INTERFACE -Wall -Wextra -Wpedantic -Wconversion -ffp-contract=off
                                               $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)
if(INSITU_WARNINGS_AS_ERRORS)
  target_compile_options(insitu_policy INTERFACE -Werror)
endif()
if(INSITU_SANITIZE)
  target_compile_options(insitu_policy INTERFACE -fsanitize=${INSITU_SANITIZE} -fno-omit-frame-pointer
                                                 -fno-sanitize-recover=all)
  target_link_options(insitu_policy INTERFACE -fsanitize=${INSITU_SANITIZE})
endif()
