"""Outputs of finished steps, kept so that another attempt of the job need not make them again."""
