# Completion of pupil: bash-completion reads this file when it is needed first. The installed program has the options.
eval "$(pupil completion bash)"
