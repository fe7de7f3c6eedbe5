"""The figures, one module for each dataset: functions from datasets to a matplotlib figure."""
