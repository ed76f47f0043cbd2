// Templates of Eigen 3.4 that dozens of files need and that are compiled once for all of them. The
// precompiled header (precompiled.h) declares them `extern`, and eigen_instances.cpp defines them.
// Each of the two defines FLEXMORPH_INSTANCE accordingly, therefore there is no #pragma once. Other
// versions of Eigen name their internal templates differently; there every file compiles its own
// copies.
#if EIGEN_WORLD_VERSION == 3 && EIGEN_MAJOR_VERSION == 4
namespace Eigen {

FLEXMORPH_INSTANCE class SparseMatrix<double>;
FLEXMORPH_INSTANCE class LLT<MatrixXd>;
FLEXMORPH_INSTANCE class LDLT<MatrixXd>;
FLEXMORPH_INSTANCE class PartialPivLU<MatrixXd>;
FLEXMORPH_INSTANCE class ColPivHouseholderQR<MatrixXd>;
FLEXMORPH_INSTANCE class CompleteOrthogonalDecomposition<MatrixXd>;
FLEXMORPH_INSTANCE class SelfAdjointEigenSolver<MatrixXd>;

namespace internal {

FLEXMORPH_INSTANCE void assign_sparse_to_sparse(SparseMatrix<double>&, const SparseMatrix<double>&);

// Products of matrices and vectors.
FLEXMORPH_INSTANCE struct general_matrix_vector_product<
    Index, double, const_blas_data_mapper<double, Index, ColMajor>, ColMajor, false, double,
    const_blas_data_mapper<double, Index, RowMajor>, false, BuiltIn>;
FLEXMORPH_INSTANCE struct general_matrix_vector_product<
    Index, double, const_blas_data_mapper<double, Index, ColMajor>, ColMajor, false, double,
    const_blas_data_mapper<double, Index, ColMajor>, false, BuiltIn>;
FLEXMORPH_INSTANCE struct general_matrix_vector_product<
    Index, double, const_blas_data_mapper<double, Index, ColMajor>, ColMajor, false, double,
    const_blas_data_mapper<double, Index, ColMajor>, false, Specialized>;
FLEXMORPH_INSTANCE struct general_matrix_vector_product<
    Index, double, const_blas_data_mapper<double, Index, RowMajor>, RowMajor, false, double,
    const_blas_data_mapper<double, Index, RowMajor>, false, BuiltIn>;
FLEXMORPH_INSTANCE struct general_matrix_vector_product<
    Index, double, const_blas_data_mapper<double, Index, RowMajor>, RowMajor, false, double,
    const_blas_data_mapper<double, Index, ColMajor>, false, BuiltIn>;
FLEXMORPH_INSTANCE struct general_matrix_vector_product<
    Index, double, const_blas_data_mapper<double, Index, RowMajor>, RowMajor, false, double,
    const_blas_data_mapper<double, Index, ColMajor>, false, Specialized>;

// Products of matrices.
FLEXMORPH_INSTANCE struct gebp_kernel<
    double, double, Index, blas_data_mapper<double, Index, 0, 0, 1>,
    gebp_traits<double, double>::mr, gebp_traits<double, double>::nr, false, false>;
FLEXMORPH_INSTANCE struct gemm_pack_lhs<double, Index, const_blas_data_mapper<double, Index, 0>,
                                        gebp_traits<double, double>::mr,
                                        gebp_traits<double, double>::LhsProgress,
                                        gebp_traits<double, double>::LhsPacket4Packing, ColMajor>;
FLEXMORPH_INSTANCE struct gemm_pack_lhs<double, Index, const_blas_data_mapper<double, Index, 1>,
                                        gebp_traits<double, double>::mr,
                                        gebp_traits<double, double>::LhsProgress,
                                        gebp_traits<double, double>::LhsPacket4Packing, RowMajor>;
FLEXMORPH_INSTANCE struct gemm_pack_rhs<double, Index, const_blas_data_mapper<double, Index, 0>,
                                        gebp_traits<double, double>::nr, ColMajor>;
FLEXMORPH_INSTANCE struct gemm_pack_rhs<double, Index, const_blas_data_mapper<double, Index, 1>,
                                        gebp_traits<double, double>::nr, RowMajor>;
FLEXMORPH_INSTANCE void evaluateProductBlockingSizesHeuristic<double, double, 1, Index>(Index&,
                                                                                        Index&,
                                                                                        Index&,
                                                                                        Index);
FLEXMORPH_INSTANCE void evaluateProductBlockingSizesHeuristic<double, double, 4, Index>(Index&,
                                                                                        Index&,
                                                                                        Index&,
                                                                                        Index);

}  // namespace internal
}  // namespace Eigen
#endif
